#include "host_tools/recording/record/recorder.h"

#include <cstdio>

#include "firmware/telemetry/topics.h"
#include "host_tools/recording/schema/message_types.h"
#include "host_tools/telemetry/wire_version.h"

namespace stilt::record {
namespace {

constexpr std::string_view kPrefix = "rt";
/// Plans are for drawing only. Their numbers hardly compress, and a replay computes them again.
constexpr std::uint32_t kOneOfPlans = 3;

}  // namespace

std::string topic_in_record(const telemetry::Topic& topic) {
  return std::string(topic.name.substr(kPrefix.size()));
}

const telemetry::Topic* topic_of_record(const std::string& name) {
  return telemetry::find_topic(std::string(kPrefix) + name);
}

std::string configuration_name(std::uint64_t run_id) {
  return "configuration_" + std::to_string(run_id) + ".toml";
}

std::vector<const telemetry::Topic*> Recorder::topics() {
  std::vector<const telemetry::Topic*> kept;
  for (const telemetry::Topic* topic : telemetry::topics()) {
    if (topic != &telemetry::kCommands) kept.push_back(topic);
  }
  return kept;
}

Recorder::Recorder(const std::string& path, const Options& options)
    : options_(options), writer_(path, {.compression = options.compression, .level = options.level}) {
  for (const telemetry::Topic* topic : topics()) static_cast<void>(channel_of(*topic));
}

std::uint16_t Recorder::channel_of(const telemetry::Topic& topic) {
  if (const auto known = channels_.find(&topic); known != channels_.end()) return known->second;
  const std::string type(topic.ros_type);
  const std::uint16_t schema =
      writer_.add_schema(type, "ros2msg", schema::ros2msg_text(schema::own_messages(), type));
  return channels_[&topic] = writer_.add_channel(schema, topic_in_record(topic), "cdr");
}

void Recorder::take(const telemetry::Sample& sample, std::int64_t now_ns) {
  const telemetry::Topic& topic = *sample.topic;
  if (&topic == &telemetry::kCommands) return;
  if (&topic == &telemetry::kPlans && plans_++ % kOneOfPlans != 0) return;
  const mcap::ByteView data(reinterpret_cast<const std::uint8_t*>(sample.cdr.data()), sample.cdr.size());
  writer_.write({channel_of(topic), counts_[&topic]++, now_ns, sample.source_time_ns, data});
  if (&topic == &telemetry::kConfiguration) {
    if (const auto message = sample.as<telemetry::ActiveConfiguration>())
      keep_configuration(*message, now_ns);
  }
  if (&topic == &telemetry::kTicks) {
    if (const auto ticks = sample.as<telemetry::TickBatch>()) {
      open_.push_back({ticks->run_id, ticks->first_tick, ticks->count});
    }
  }
  count_written();
}

/// What the file did not take, on a full disk, is not counted.
void Recorder::count_written() {
  if (writer_.has_open_chunk()) return;
  for (const Ticks& ticks : open_) runs_[ticks.run_id].add(ticks.first, ticks.count);
  open_.clear();
}

void Recorder::flush() {
  writer_.flush();
  count_written();
}

void Recorder::keep_configuration(const telemetry::ActiveConfiguration& configuration, std::int64_t now_ns) {
  if (const auto wrong = host_telemetry::wire_version_problem(configuration.wire_version)) {
    char run[24];
    std::snprintf(run, sizeof run, "%016llx", static_cast<unsigned long long>(configuration.run_id));
    problem_ = std::string("run ") + run + " " + *wrong;
  }
  writer_.attach({now_ns, configuration.start_time_ns, configuration_name(configuration.run_id),
                  "application/toml", configuration.configuration});
  const std::string robot = configuration.robot;
  const std::string urdf = configuration.urdf;
  if (!urdf.empty()) writer_.attach({now_ns, now_ns, robot + ".urdf", "application/xml", urdf});
  writer_.write_metadata({"stiltd",
                          {{"run_id", std::to_string(configuration.run_id)},
                           {"robot", robot},
                           {"version", configuration.version},
                           {"compiler", configuration.compiler},
                           {"instruction_set", configuration.instruction_set},
                           {"wire_version", std::to_string(configuration.wire_version)}}});
}

void Recorder::close() {
  writer_.close();
  count_written();
}

}  // namespace stilt::record
