#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "hal/can/bytes.h"
#include "hal/odrive/odrive_cansimple.h"
#include "hal/odrive/odrive_emulator.h"
#include "tests/hal/traces/firmware_trace.h"

// Our ODrive codec against the messages of ODrive's own library.
namespace stilt::hal::odrive {
namespace {

using testing::TraceEvent;

/// Values of a message beside its frame.
using Check = std::function<void(std::uint8_t node, const TraceEvent& said, const CanFrame& frame)>;

template <class Message>
Message decoded(std::uint8_t node, const CanFrame& frame) {
  Message message;
  EXPECT_EQ(decode(node, frame, message), DecodeStatus::ok);
  return message;
}

std::uint8_t byte(const TraceEvent& said, std::size_t i) {
  return static_cast<std::uint8_t>(said.integer(i));
}
std::uint32_t bits(const TraceEvent& said, std::size_t i) {
  return static_cast<std::uint32_t>(std::stoul(said.words.at(i)));
}
void expect_turns(double value_rad, double turns) {
  EXPECT_DOUBLE_EQ(value_rad, static_cast<double>(static_cast<float>(turns)) * kRadiansPerRevolution);
}
void expect_float(double value, double wanted) {
  EXPECT_EQ(static_cast<float>(value), static_cast<float>(wanted));
}
/// A message of two numbers.
template <class Message, auto first, auto second>
void two_floats(std::uint8_t node, const TraceEvent& said, const CanFrame& frame) {
  const auto message = decoded<Message>(node, frame);
  expect_float(message.*first, said.number(0));
  expect_float(message.*second, said.number(1));
}
/// Their library fills every message with zeros to 8 bytes; their example can_simple.py does not.
void expect_bytes(const CanFrame& ours, const CanFrame& theirs) {
  EXPECT_EQ(ours.id, theirs.id);
  CanFrame filled = ours;
  filled.length = kClassicFrameBytes;
  EXPECT_EQ(testing::hex(filled), testing::hex(theirs));
}

const std::map<std::string, Check> kChecks{
    {"version",
     [](auto node, const auto& said, const auto& frame) {
       const OdriveVersion expected{2,
                                    byte(said, 0),
                                    byte(said, 1),
                                    byte(said, 2),
                                    byte(said, 3),
                                    byte(said, 4),
                                    byte(said, 5),
                                    byte(said, 6)};
       EXPECT_EQ(decoded<OdriveVersion>(node, frame), expected);
     }},
    {"heartbeat",
     [](auto node, const auto& said, const auto& frame) {
       const OdriveHeartbeat expected{bits(said, 0), byte(said, 1), byte(said, 2), said.integer(3) == 1};
       EXPECT_EQ(decoded<OdriveHeartbeat>(node, frame), expected);
     }},
    {"errors",
     [](auto node, const auto& said, const auto& frame) {
       EXPECT_EQ(decoded<OdriveErrors>(node, frame), (OdriveErrors{bits(said, 0), bits(said, 1)}));
     }},
    {"estimates",
     [](auto node, const auto& said, const auto& frame) {
       const auto estimates = decoded<OdriveEstimates>(node, frame);
       expect_turns(estimates.position_rad, said.number(0));
       expect_turns(estimates.velocity_rad_s, said.number(1));
     }},
    {"torques", two_floats<OdriveTorques, &OdriveTorques::target_Nm, &OdriveTorques::estimate_Nm>},
    {"temperatures",
     two_floats<OdriveTemperatures, &OdriveTemperatures::driver_C, &OdriveTemperatures::motor_C>},
    {"supply", two_floats<OdriveSupply, &OdriveSupply::voltage_V, &OdriveSupply::current_A>},
    {"set_state",
     [](auto node, const auto& said, const auto& frame) {
       CanFrame ours;
       ASSERT_EQ(encode_set_state(node, bits(said, 0), ours), EncodeStatus::ok);
       expect_bytes(ours, frame);
     }},
    {"set_controller_mode",
     [](auto node, const auto& said, const auto& frame) {
       CanFrame ours;
       ASSERT_EQ(encode_set_controller_mode(node, static_cast<OdriveControlMode>(said.integer(0)),
                                            static_cast<OdriveInputMode>(said.integer(1)), ours),
                 EncodeStatus::ok);
       expect_bytes(ours, frame);
     }},
    {"set_input_torque",
     [](auto node, const auto& said, const auto& frame) {
       CanFrame ours;
       ASSERT_EQ(encode_input_torque(node, said.number(0), ours), EncodeStatus::ok);
       expect_bytes(ours, frame);
     }},
};

TEST(OdriveTraces, EveryMessageIsThatOfTheVendorsLibrary) {
  const auto scenarios = testing::read_trace("odrive.trace");
  ASSERT_EQ(scenarios.size(), 1u);
  const auto& events = scenarios[0].events;
  int messages = 0;
  for (std::size_t i = 0; i + 1 < events.size(); i += 2, ++messages) {
    const CanFrame frame = events[i + 1].frame();
    SCOPED_TRACE(events[i].kind + ", message " + std::to_string(messages));
    const auto check = kChecks.find(events[i].kind);
    ASSERT_NE(check, kChecks.end());
    check->second(static_cast<std::uint8_t>(frame.id >> 5), events[i], frame);
  }
  EXPECT_EQ(messages, 400);
}

/// What our emulator sends in this millisecond, with what it was given at its end.
std::string sent_by(OdriveEmulator& emulator, std::int64_t time_ns, const TraceEvent* given) {
  FrameSink replies;
  emulator.elapse(time_ns, replies);
  if (given != nullptr) {
    CanFrame frame = given->frame();
    frame.remote = given->kind == "?";
    emulator.take(time_ns, frame, replies);
  }
  std::string text;
  for (const CanFrame& frame : replies.frames()) {
    const bool is_the_first = time_ns == 0;  // their timers begin with a period, ours with a frame
    if (!is_the_first) text += std::to_string(frame.id) + " " + testing::hex(frame) + "; ";
  }
  return text;
}

TEST(OdriveTraces, TheEmulatorOfFirmware05SendsAndAnswersAsTheFirmwareDid) {
  const auto scenarios = testing::read_trace("odrive_0_5.trace");
  ASSERT_EQ(scenarios.size(), 1u);
  const auto& trace = scenarios[0];
  OdriveSettings settings;
  settings.answers_version = false;
  settings.torque_mode_limit = false;
  settings.heartbeat_period_ns = std::llround(trace.settings.at("heartbeat_rate_ms")) * 1'000'000;
  settings.estimates_period_ns = std::llround(trace.settings.at("encoder_rate_ms")) * 1'000'000;
  OdriveEmulator emulator({3, {}}, settings);
  emulator.motor.supply_V = trace.settings.at("supply_V");
  // The torque of the trace is the one that was asked for: the motor's in torque mode.
  CanFrame mode;
  ASSERT_EQ(encode_set_controller_mode(3, OdriveControlMode::torque, OdriveInputMode::passthrough, mode),
            EncodeStatus::ok);
  FrameSink none;
  emulator.take(0, mode, none);
  std::string theirs, ours;
  std::int64_t tick_ns = 0;
  int frames = 0;
  for (const TraceEvent& event : trace.events) {
    if (event.kind == "error" && event.words.back() == "controller") break;  // no such errors here
    while (tick_ns + 1'000'000 <= event.time_ns) ours += sent_by(emulator, tick_ns += 1'000'000, nullptr);
    if (event.kind == "motor") {
      emulator.motor.position_rad = event.number(0) * kRadiansPerRevolution;
      emulator.motor.velocity_rad_s = event.number(1) * kRadiansPerRevolution;
      static_cast<void>(sent_by(emulator, 0, nullptr));
    } else if (event.kind == "<") {
      ++frames;
      theirs += std::to_string(event.frame().id) + " " + testing::hex(event.frame()) + "; ";
    } else if (event.kind == ">" || (event.kind == "?" && event.frame().id != (3u << 5 | 0x1d))) {
      ours += sent_by(emulator, tick_ns, &event);
    } else if (event.kind == "?") {
      ours += "125 0000000000000000; ";  // errors of its controller: nothing asks for them
    } else if (event.kind == "torque") {
      EXPECT_EQ(emulator.torque_Nm(), event.number(0));
    } else if (event.kind == "error" && event.words.back() == "motor") {
      emulator.raise(DriverFault::over_current);
    }
  }
  EXPECT_GT(frames, 50);
  EXPECT_EQ(ours, theirs);
}

}  // namespace
}  // namespace stilt::hal::odrive
