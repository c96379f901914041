#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/control_loop/tick_record.h"
#include "firmware/robots/robots.h"
#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/reader.h"
#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/topics.h"
#include "firmware/telemetry/wire_version.h"
#include "host_tools/recording/mcap/writer.h"
#include "host_tools/recording/schema/message_types.h"

/// Samples as they come from stiltd, made without a network.
namespace stilt::record {

inline control_loop::TickRecord sample_tick(std::uint64_t number) {
  control_loop::TickRecord tick;
  tick.tick = number;
  tick.time_ns = 5'000'000'000 + static_cast<std::int64_t>(number) * 1'000'000;
  tick.estimated_state[1] = 0.75;
  tick.stance_episode = 1;
  tick.sent[2].torque_Nm = 0.125 * static_cast<double>(number);
  return tick;
}

inline telemetry::Sample ticks_sample(std::uint64_t run_id, std::uint64_t first, std::size_t count) {
  telemetry::TickBatchBuilder batch;
  for (std::size_t i = 0; i < count; ++i) batch.add(sample_tick(first + i));
  batch.message().run_id = run_id;
  return {&telemetry::kTicks, 1'000, 1, telemetry::encode(batch.message())};
}

inline telemetry::Sample configuration_sample(std::uint64_t run_id, std::string toml,
                                              std::uint32_t wire_version = telemetry::kWireVersion,
                                              std::string robot = "amber3m", std::int64_t start_clock_ns = 0,
                                              std::string urdf = "") {
  std::string version = "9.9", other = "x";
  telemetry::ActiveConfiguration message{};
  message.run_id = run_id;
  message.robot = robot.data();
  message.configuration = toml.data();
  message.version = version.data();
  for (char** text : {&message.compiler, &message.instruction_set, &message.realtime, &message.token_file}) {
    *text = other.data();
  }
  message.wire_version = wire_version;
  message.start_clock_ns = start_clock_ns;
  message.urdf = urdf.data();
  return {&telemetry::kConfiguration, 2'000, 1, telemetry::encode(message)};
}

/// A URDF of the shipped robot with longer thighs, and their length.
inline constexpr double kLongThigh_m = 0.5;
inline std::string long_urdf() {
  std::string text;
  for (const robots::ShippedUrdf& shipped : robots::shipped_urdfs()) {
    if (shipped.name == "amber3m") text = shipped.text;
  }
  const std::string thigh = "<origin xyz=\"0 0 -0.4064\"/>";
  std::size_t at = text.find(thigh);
  if (at == std::string::npos) throw std::logic_error("the shipped thigh is another one");
  for (; at != std::string::npos; at = text.find(thigh)) {
    text.replace(at, thigh.size(), "<origin xyz=\"0 0 -0.5\"/>");
  }
  return text;
}

inline telemetry::Sample event_sample(std::uint64_t run_id, std::string text) {
  std::string name = "walk";
  telemetry::Event message{};
  message.run_id = run_id;
  message.name = name.data();
  message.text = text.data();
  message.time_s = 0.1;
  return {&telemetry::kEvents, 3'000, 1, telemetry::encode(message)};
}

/// A record of release 0.1: the message with the configuration has no wire version, in its bytes and in its
/// definition.
inline void write_record_of_0_1(const std::string& path) {
  const std::string type = "stilt_msgs/msg/Configuration";
  schema::MessageTypes types = schema::own_messages();
  types.at(type).pop_back();  // urdf
  types.at(type).pop_back();  // wire_version
  const telemetry::Sample sample = configuration_sample(7, "");
  const mcap::Bytes body(reinterpret_cast<const std::uint8_t*>(sample.cdr.data()),
                         reinterpret_cast<const std::uint8_t*>(sample.cdr.data() + sample.cdr.size()) -
                             2 * sizeof(std::uint32_t) - 1);
  mcap::Writer writer(path);
  const std::uint16_t schema = writer.add_schema(type, "ros2msg", schema::ros2msg_text(types, type));
  const std::uint16_t channel = writer.add_channel(schema, "/stilt/configuration", "cdr");
  writer.write({channel, 0, 1, 1, body});
  writer.close();
}

}  // namespace stilt::record
