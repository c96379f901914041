#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hal/can/bytes.h"
#include "hal/moteus/moteus_driver.h"
#include "hal/moteus/moteus_emulator.h"
#include "tests/hal/traces/firmware_trace.h"

// Our moteus codec and our emulated moteus against what the vendor's firmware did.
namespace stilt::hal::moteus {
namespace {

using testing::TraceEvent;
using testing::TraceScenario;

constexpr char kFile[] = "moteus.trace";
constexpr std::int64_t kStep_ns = 33'333;  // of the driver's loop
/// The firmware looks at its power stage every millisecond, at any phase; and a step of its loop.
constexpr std::int64_t kModeTolerance_ns = 1'100'000;
constexpr std::uint8_t kFirstLimitCode = 96;  // names what limits the torque: no fault

TraceScenario scenario(const std::string& name) {
  for (const TraceScenario& each : testing::read_trace(kFile)) {
    if (each.name == name) return each;
  }
  ADD_FAILURE() << "no scenario '" << name << "'";
  return {};
}

MoteusDriver driver_of(const TraceScenario& trace) {
  MoteusDriver driver;
  driver.kp_Nm_rev = trace.settings.at("kp");
  driver.kd_Nm_s_rev = trace.settings.at("kd");
  return driver;
}

MoteusSettings settings_of(const TraceScenario& trace) {
  const auto& of = trace.settings;
  MoteusSettings settings;
  settings.kp_Nm_rev = of.at("kp");
  settings.ki = of.at("ki");
  settings.kd_Nm_s_rev = of.at("kd");
  settings.default_accel_limit_rev_s2 = of.at("accel_limit");
  settings.default_velocity_limit_rev_s = of.at("velocity_limit");
  settings.bounds = {of.at("position_min"), of.at("position_max")};
  settings.bemf_feedforward = of.at("bemf_feedforward");
  settings.timeout_mode = static_cast<MoteusTimeout>(static_cast<int>(of.at("timeout_mode")));
  settings.timeout_max_torque_Nm = of.at("timeout_max_torque");
  return settings;
}

CanFrame fd_frame(const TraceEvent& event) {
  CanFrame frame = event.frame();
  frame.fd = frame.bit_rate_switch = true;
  return frame;
}

/// Half a step of an int16 register, or that of a float of this size.
void expect_register(double value, double wanted, double unit, const char* what) {
  if (std::isnan(wanted)) {
    EXPECT_TRUE(std::isnan(value)) << what;
    return;
  }
  const double reached = std::clamp(wanted, -32767 * unit, 32767 * unit);
  EXPECT_NEAR(value, reached, 0.5 * unit + 1e-6 * std::abs(reached)) << what;
}

TEST(MoteusTraces, TheFirmwareReadsOurCommandsAsMeant) {
  const TraceScenario trace = scenario("commands as the firmware reads them");
  const MoteusDriver driver = driver_of(trace);
  int commands = 0;
  for (std::size_t i = 0; i + 2 < trace.events.size(); ++i) {
    const TraceEvent& command = trace.events[i];
    if (command.kind != "command") continue;
    const MoteusCommand wanted{command.number(0), command.number(1), command.number(2), command.number(3),
                               command.number(4), command.number(5), command.number(6)};
    CanFrame frame;
    ASSERT_LE(encode_command(driver, wanted, frame), EncodeStatus::saturated);
    ASSERT_EQ(testing::hex(frame), trace.events[i + 1].words.at(1)) << "command " << commands;
    const TraceEvent& registers = trace.events[i + 2];
    EXPECT_EQ(registers.integer(0), static_cast<int>(MoteusMode::position));
    const double gain = kRadiansPerRevolution;
    expect_register(registers.number(1), wanted.position_rad / kRadiansPerRevolution, 1e-4, "position");
    expect_register(registers.number(2), wanted.velocity_rad_s / kRadiansPerRevolution, 2.5e-4, "velocity");
    expect_register(registers.number(3), wanted.torque_Nm, 0.01, "torque");
    expect_register(registers.number(4), wanted.kp_Nm_rad * gain / driver.kp_Nm_rev, 1.0 / 32767, "kp scale");
    expect_register(registers.number(5), wanted.kd_Nms_rad * gain / driver.kd_Nm_s_rev, 1.0 / 32767,
                    "kd scale");
    expect_register(registers.number(6), wanted.maximum_torque_Nm, 0.01, "torque limit");
    expect_register(registers.number(7), wanted.watchdog_s, 0.001, "watchdog");
    EXPECT_LT(registers.number(8), 0) << "no limit of the acceleration";
    ++commands;
  }
  EXPECT_EQ(commands, 200);
}

TEST(MoteusTraces, RepliesOfTheFirmwareReadAsItsState) {
  const TraceScenario trace = scenario("replies of the firmware");
  const MoteusDriver driver = driver_of(trace);
  int replies = 0;
  for (std::size_t i = 0; i + 2 < trace.events.size(); ++i) {
    const TraceEvent& status = trace.events[i];
    if (status.kind != "status") continue;
    MoteusReply reply;
    ASSERT_EQ(decode_reply(driver, fd_frame(trace.events[i + 2]), reply), DecodeStatus::ok);
    EXPECT_EQ(reply.mode, status.integer(0));
    EXPECT_EQ(reply.fault_code, status.integer(1));
    const double turn = kRadiansPerRevolution;
    EXPECT_NEAR(reply.position_rad, status.number(2) * turn, 1e-5 * turn);  // firmware cuts off
    EXPECT_NEAR(reply.velocity_rad_s, status.number(3) * turn, 2e-5 * turn);
    EXPECT_NEAR(reply.torque_Nm, status.number(4), 0.0011);
    EXPECT_NEAR(reply.voltage_V, status.number(5), 0.51);
    EXPECT_NEAR(reply.temperature_C, status.number(6), 1.01);
    if (replies % 2 == 0 && !std::isnan(status.number(7))) {
      EXPECT_NEAR(reply.motor_temperature_C, status.number(7), 1.01);
    } else {
      EXPECT_TRUE(std::isnan(reply.motor_temperature_C));
    }
    ++replies;
  }
  EXPECT_EQ(replies, 200);
}

/// NaN is the same as NaN.
void expect_same(double ours, double theirs, double tolerance, const std::string& where) {
  EXPECT_EQ(std::isnan(ours), std::isnan(theirs)) << where;
  if (!std::isnan(theirs)) {
    EXPECT_NEAR(ours, theirs, tolerance) << where;
  }
}

/// Question, answer, as a bring-up asks.
std::string asked(MoteusEmulator& driver, const MoteusDriver& described, const std::string& name) {
  ConsoleReader reader;
  reader.begin();
  for (std::int64_t now_ns = 1'000'000; now_ns < 100'000'000; now_ns += 1'000'000) {
    CanFrame frame;
    FrameSink replies;
    EXPECT_EQ(reader.ask(described, "conf get " + name, false, frame), EncodeStatus::ok);
    driver.take(now_ns, frame, replies);
    if (replies.frames().size() != 1) return "no reply";
    if (reader.take(described, replies.frames()[0]) == ConsoleReader::Progress::answer) {
      return std::string(reader.answer());
    }
  }
  return "no answer";
}

/// The traces begin after `tel stop`, which the reader sends first.
void stop_telemetry(ConsoleReader& reader, const MoteusDriver& described) {
  CanFrame question, answer;
  EXPECT_EQ(reader.ask(described, "conf get servo.timeout_mode", false, question), EncodeStatus::ok);
  EXPECT_EQ(decode_console_request(described, question)->view().substr(0, 9), "tel stop\n");
  EXPECT_EQ(encode_console_answer(described, question, "", answer), EncodeStatus::ok);
  EXPECT_EQ(reader.take(described, answer), ConsoleReader::Progress::more);
}

TEST(MoteusTraces, SettingsReadOverTheCommandLineAsTheFirmwareWritesThem) {
  int answers = 0;
  for (const TraceScenario& trace : testing::read_trace(kFile)) {
    if (!trace.name.starts_with("settings")) continue;
    const MoteusDriver described = driver_of(trace);
    MoteusEmulator emulator(described, settings_of(trace));
    ConsoleReader reader;
    reader.begin();
    stop_telemetry(reader, described);
    std::size_t i = 0;
    for (const TraceEvent& answer : trace.events) {
      if (answer.kind != "answer") continue;
      const std::string value = testing::rest_of(answer, 1);
      auto progress = ConsoleReader::Progress::more;
      for (; progress == ConsoleReader::Progress::more && i + 1 < trace.events.size(); ++i) {
        if (trace.events[i].kind != ">") continue;
        CanFrame frame;
        ASSERT_EQ(reader.ask(described, "conf get " + answer.words[0], false, frame), EncodeStatus::ok);
        ASSERT_EQ(testing::hex(frame), trace.events[i].words.at(1));
        progress = reader.take(described, fd_frame(trace.events[i + 1]));
      }
      ASSERT_EQ(progress, ConsoleReader::Progress::answer) << answer.words[0];
      EXPECT_EQ(reader.answer(), value) << answer.words[0];
      EXPECT_EQ(asked(emulator, described, answer.words[0]), value) << answer.words[0];
      ++answers;
    }
  }
  EXPECT_EQ(answers, 22);
}

struct ModeChange {
  std::int64_t time_ns = 0;
  int mode = 0;
  int fault = 0;
};

/// Drives the emulated moteus with the commands of a trace and its motor with the trace's motion.
class Replay {
 public:
  explicit Replay(const TraceScenario& trace)
      : trace_(trace), described_(driver_of(trace)), driver_(described_, settings_of(trace)) {
    driver_.motor.supply_V = 24;
    driver_.motor.temperature_C = 31;
  }

  void run() {
    for (const TraceEvent& event : trace_.events) {
      pass(event.time_ns);
      if (event.kind == "motor") {
        driver_.motor.position_rad = event.number(0) * kRadiansPerRevolution;
        driver_.motor.velocity_rad_s = event.number(1) * kRadiansPerRevolution;
      } else if (event.kind == ">") {
        answered_ = {};
        driver_.take(now_ns_, fd_frame(event), answered_);
        note_mode();
      } else if (event.kind == "<") {
        compare(event);
      } else if (event.kind == "mode") {
        const int fault = event.integer(1) < kFirstLimitCode ? event.integer(1) : 0;
        firmware_modes_.push_back({event.time_ns, event.integer(0), fault});
      } else if (event.kind == "torque") {
        EXPECT_NEAR(driver_.torque_Nm(), event.number(0), 0.01 + 0.03 * std::abs(event.number(0)))
            << trace_.name << ", " << event.time_ns / 1000 << " us";
      }
    }
    compare_modes();
  }

  [[nodiscard]] int replies() const { return replies_; }

 private:
  void pass(std::int64_t until_ns) {
    while (now_ns_ < until_ns) {
      const std::int64_t step_ns = std::min(kStep_ns, until_ns - now_ns_);
      now_ns_ += step_ns;
      driver_.motor.position_rad += driver_.motor.velocity_rad_s * static_cast<double>(step_ns) * 1e-9;
      FrameSink none;
      driver_.elapse(now_ns_, none);
      note_mode();
    }
  }

  void note_mode() {
    const int mode = static_cast<int>(driver_.mode());
    if (modes_.empty() ? mode != 0 : mode != modes_.back().mode) modes_.push_back({now_ns_, mode, fault()});
  }

  [[nodiscard]] int fault() {
    CanFrame question;
    FrameSink sink;
    MoteusReply reply;
    EXPECT_EQ(encode_query(described_, MoteusQuery::state, question), EncodeStatus::ok);
    driver_.take(now_ns_, question, sink);
    if (sink.frames().empty() || decode_reply(described_, sink.frames()[0], reply) != DecodeStatus::ok)
      return -1;
    return reply.fault_code;
  }

  /// Both modes are compared with their times; here a reply counts whose mode has lasted.
  [[nodiscard]] bool changing() const {
    const auto recent = [this](const std::vector<ModeChange>& changes) {
      return !changes.empty() && now_ns_ - changes.back().time_ns <= kModeTolerance_ns;
    };
    return recent(modes_) || recent(firmware_modes_);
  }

  void compare(const TraceEvent& event) {
    MoteusReply theirs, ours;
    ASSERT_EQ(decode_reply(described_, fd_frame(event), theirs), DecodeStatus::ok) << event.words.at(1);
    ASSERT_EQ(answered_.frames().size(), 1u) << trace_.name << ", " << event.time_ns / 1000 << " us";
    const CanFrame& answer = answered_.frames()[0];
    EXPECT_EQ(answer.id, fd_frame(event).id);
    if (decode_console(described_, fd_frame(event))) {  // its text may be split otherwise
      EXPECT_TRUE(decode_console(described_, answer));
      return;
    }
    EXPECT_EQ(answer.length, fd_frame(event).length);
    ASSERT_EQ(decode_reply(described_, answer, ours), DecodeStatus::ok);
    ++replies_;
    const auto at = [&] { return trace_.name + ", " + std::to_string(event.time_ns / 1000) + " us"; };
    EXPECT_EQ(ours.home, theirs.home) << at();
    EXPECT_EQ(ours.firmware_version, theirs.firmware_version) << at();
    EXPECT_EQ(ours.register_map_version, theirs.register_map_version) << at();
    expect_same(ours.position_rad, theirs.position_rad, 2e-3, at());
    expect_same(ours.watchdog_s, theirs.watchdog_s, 1e-5, at());
    if (changing()) return;
    EXPECT_EQ(ours.mode, theirs.mode) << at();
    EXPECT_EQ(ours.fault_code, theirs.fault_code < kFirstLimitCode ? theirs.fault_code : 0) << at();
    EXPECT_EQ(ours.has_control, theirs.has_control) << at();
    if (!ours.has_control || !std::isfinite(theirs.control_position_rad)) return;
    EXPECT_NEAR(ours.control_position_rad, theirs.control_position_rad, 0.015) << at();
    EXPECT_NEAR(std::abs(ours.proportional_Nm), std::abs(theirs.proportional_Nm), 0.05) << at();
    EXPECT_NEAR(std::abs(ours.derivative_Nm), std::abs(theirs.derivative_Nm), 0.02) << at();
  }

  void compare_modes() {
    std::erase_if(firmware_modes_, [](const ModeChange& change) {  // lasts one step of the loop
      return change.mode == static_cast<int>(MoteusMode::calibrated);
    });
    ASSERT_EQ(modes_.size(), firmware_modes_.size()) << trace_.name;
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      EXPECT_EQ(modes_[i].mode, firmware_modes_[i].mode) << trace_.name << ", change " << i;
      EXPECT_EQ(modes_[i].fault, firmware_modes_[i].fault) << trace_.name << ", change " << i;
      EXPECT_NEAR(static_cast<double>(modes_[i].time_ns), static_cast<double>(firmware_modes_[i].time_ns),
                  kModeTolerance_ns)
          << trace_.name << ", mode " << modes_[i].mode;
    }
  }

  const TraceScenario& trace_;
  MoteusDriver described_;
  MoteusEmulator driver_;
  FrameSink answered_;
  std::int64_t now_ns_ = 0;
  int replies_ = 0;
  std::vector<ModeChange> modes_;
  std::vector<ModeChange> firmware_modes_;
};

TEST(MoteusTraces, TheEmulatorAnswersAndChangesItsModeAsTheFirmwareDid) {
  int scenarios = 0, replies = 0;
  for (const TraceScenario& trace : testing::read_trace(kFile)) {
    const bool codec = trace.name == "replies of the firmware" || trace.name.starts_with("commands as") ||
                       trace.name.starts_with("settings");
    if (codec) continue;
    SCOPED_TRACE(trace.name);
    Replay replay(trace);
    replay.run();
    replies += replay.replies();
    ++scenarios;
  }
  EXPECT_EQ(scenarios, 10);
  EXPECT_GT(replies, 500);
}

}  // namespace
}  // namespace stilt::hal::moteus
