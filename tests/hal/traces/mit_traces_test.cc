#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/mit/mit_emulator.h"
#include "tests/hal/traces/firmware_trace.h"

// Our MIT-mode codec and our emulated mini-cheetah against what that firmware did.
namespace stilt::hal::mit {
namespace {

using testing::TraceEvent;
using testing::TraceScenario;

constexpr int kMotorMode = 2;
constexpr std::int64_t kLoop_ns = 25'000;
/// The firmware changes its mode in the loop after the frame.
constexpr std::int64_t kModeTolerance_ns = 3 * kLoop_ns;

/// As the firmware comes: I_MAX 18 A at 1 Nm/A.
MitDriver described() { return {}; }

TraceScenario scenario(const std::string& name) {
  for (const TraceScenario& each : testing::read_trace("mini_cheetah.trace")) {
    if (each.name == name) return each;
  }
  ADD_FAILURE() << "no scenario '" << name << "'";
  return {};
}

TEST(MiniCheetahTraces, TheFirmwareReadsOurCommandsAsMeant) {
  const TraceScenario trace = scenario("commands as the firmware reads them");
  const MitDriver driver = described();
  const Range ranges[] = {driver.position_rad, driver.velocity_rad_s, driver.kp_Nm_rad, driver.kd_Nms_rad,
                          driver.torque_Nm};
  const unsigned bits[] = {16, 12, 12, 12, 12};
  int commands = 0;
  for (std::size_t i = 0; i + 2 < trace.events.size(); ++i) {
    const TraceEvent& command = trace.events[i];
    if (command.kind != "command") continue;
    CanFrame frame;
    ASSERT_EQ(encode_command(driver,
                             {command.number(0), command.number(1), command.number(2), command.number(3),
                              command.number(4)},
                             frame),
              EncodeStatus::ok);
    ASSERT_EQ(testing::hex(frame), trace.events[i + 1].words.at(1)) << "command " << commands;
    for (std::size_t value = 0; value < 5; ++value) {
      const double below = command.number(value) - trace.events[i + 2].number(value);  // cut off
      const double step = mit::step(ranges[value], bits[value]);
      EXPECT_GE(below, -0.01 * step) << "value " << value;
      EXPECT_LE(below, 1.01 * step) << "value " << value;
    }
    ++commands;
  }
  EXPECT_EQ(commands, 200);
}

TEST(MiniCheetahTraces, RepliesOfTheFirmwareReadAsItsState) {
  const TraceScenario trace = scenario("replies of the firmware");
  const MitDriver driver = described();
  int replies = 0;
  for (std::size_t i = 0; i + 1 < trace.events.size(); i += 2, ++replies) {
    MitReply reply;
    ASSERT_EQ(decode_reply(driver, trace.events[i + 1].frame(), reply), DecodeStatus::ok);
    EXPECT_NEAR(reply.position_rad, trace.events[i].number(0), 1.01 * step(driver.position_rad, 16));
    EXPECT_NEAR(reply.velocity_rad_s, trace.events[i].number(1), 1.01 * step(driver.velocity_rad_s, 12));
  }
  EXPECT_EQ(replies, 200);
}

TEST(MiniCheetahTraces, TheEmulatorAnswersSwitchesAndEndsItsCommandAsTheFirmwareDid) {
  const TraceScenario trace = scenario("off, on, commands, silence, on again");
  const MitDriver driver = described();
  MitBehaviour behaviour;
  behaviour.command_timeout_ns = static_cast<std::int64_t>(trace.settings.at("can_timeout_us") * 1000);
  MitEmulator emulator(driver, documented_settings(driver), 5, behaviour);
  std::int64_t now_ns = 0;
  std::int64_t changed_ns = 0;
  FrameSink answered;
  int modes = 0, replies = 0, torques = 0;
  for (const TraceEvent& event : trace.events) {
    SCOPED_TRACE(std::to_string(event.time_ns / 1000) + " us, " + event.kind);
    while (now_ns < event.time_ns) {
      const std::int64_t step_ns = std::min(kLoop_ns, event.time_ns - now_ns);
      const bool was_enabled = emulator.enabled();
      now_ns += step_ns;
      emulator.motor.position_rad += emulator.motor.velocity_rad_s * static_cast<double>(step_ns) * 1e-9;
      FrameSink none;
      emulator.elapse(now_ns, none);
      if (emulator.enabled() != was_enabled) changed_ns = now_ns;
    }
    if (event.kind == "motor") {
      emulator.motor.position_rad = event.number(0);
      emulator.motor.velocity_rad_s = event.number(1);
    } else if (event.kind == ">") {
      const bool was_enabled = emulator.enabled();
      answered = {};
      emulator.take(now_ns, event.frame(), answered);
      if (emulator.enabled() != was_enabled) changed_ns = now_ns;
    } else if (event.kind == "<") {
      MitReply ours, theirs;
      ASSERT_EQ(answered.frames().size(), 1u);
      ASSERT_EQ(decode_reply(driver, answered.frames()[0], ours), DecodeStatus::ok);
      ASSERT_EQ(decode_reply(driver, event.frame(), theirs), DecodeStatus::ok);
      EXPECT_EQ(answered.frames()[0].length, event.frame().length);
      EXPECT_NEAR(ours.position_rad, theirs.position_rad, 0.002);
      EXPECT_NEAR(ours.velocity_rad_s, theirs.velocity_rad_s, 1.01 * step(driver.velocity_rad_s, 12));
      ++replies;
    } else if (event.kind == "mode") {
      EXPECT_EQ(emulator.enabled(), event.integer(0) == kMotorMode);
      EXPECT_LE(now_ns - changed_ns, kModeTolerance_ns);
      ++modes;
    } else if (event.kind == "torque") {
      EXPECT_NEAR(emulator.torque_Nm(), event.number(0), 0.05);  // steps of velocity and torque
      ++torques;
    }
  }
  EXPECT_EQ(modes, 4);
  EXPECT_EQ(replies, 34);
  EXPECT_EQ(torques, 11);
}

}  // namespace
}  // namespace stilt::hal::mit
