// A fault while the robot walks, its cause gone, a reset over DDS: the robot stands up and walks again, with
// the same stiltd. Where a driver that counts from power-up was silent, its bring-up is refused instead. In
// lock-step; the gantry lifts the robot after its fall, as a person would.
#include <gtest/gtest.h>

#include <string_view>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/telemetry/token.h"
#include "tests/two_processes/host.h"
#include "tests/two_processes/protocols.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using supervisor::Fault;
using supervisor::State;
using telemetry::CommandKind;

/// What goes wrong, and what the supervisor must find.
struct Cause {
  const char* name;
  const char* fault;  ///< option of the robot; it goes by itself, or with the reset
  Fault latched;
  const char* found;      ///< part of what its message has been found by
  const char* protocols;  ///< those by which a driver can show it
  bool silences = false;  ///< drivers
};

constexpr const char* kAll = "mit_damiao mit_ak mit_mini_cheetah moteus odrive ak_v3";
constexpr const char* kWithCodes =
    "mit_damiao mit_ak moteus odrive ak_v3";  // a mini-cheetah reports no state

constexpr Cause kCauses[] = {
    {"DriverFault", "driver-fault:knee_L@2", Fault::driver_fault, "knee_L, ", kWithCodes},
    {"SilentTorsoSensor", "base-silent@2+1", Fault::stale_torso_sensor, "silent", kAll},
    {"EmergencyStop", "emergency-stop@2+1", Fault::emergency_stop, "pressed", kAll},
    {"BusOff", "bus-off:1@2+0.2", Fault::bus_off, "bus 1", kAll, true},
    {"PowerCycle", "power-cycle@2", Fault::lost_replies, "limit 10 ticks", kAll, true},
    {"FrozenEncoder", "encoder-freeze@2+1", Fault::encoder_frozen, "knee_L", kAll},
    {"DeadDriver", "power-cycle:hip_R@2+1", Fault::lost_replies, "hip_R", kAll, true},
    {"TorqueLost", "torque-loss@2+1", Fault::torque_mismatch, "knee_L", kAll},
    {"SilentBus", "drop:0@2+1", Fault::lost_replies, "hip_L", kAll, true},
    {"FrozenTorsoSensor", "base-freeze@2+1", Fault::stale_torso_sensor, "repeats", kAll},
    {"Overheated", "over-temperature:hip_L@2+6", Fault::driver_overheated, "hip_L", kWithCodes},
    {"LowVoltage", "low-voltage@2+6", Fault::low_voltage, "hip_L, 30 V", "moteus odrive"},
    {"UnderVoltage", "low-voltage@2+1", Fault::driver_fault, "hip_L", "mit_ak mit_damiao ak_v3"},
};

struct Case {
  Cause cause;
  const char* protocol;
};

std::string name(const Case& one) { return std::string(one.cause.name) + "_" + one.protocol; }

void PrintTo(const Case& one, std::ostream* out) { *out << one.protocol << ", " << one.cause.fault; }

std::vector<const char*> protocols_of(const Cause& cause) {
  std::vector<const char*> protocols(std::begin(kProtocols), std::end(kProtocols));
  std::erase_if(protocols, [&](const char* protocol) {
    return std::string_view(cause.protocols).find(protocol) == std::string_view::npos;
  });
  return protocols;
}

/// Every cause, each with the next protocol.
std::vector<Case> each_cause() {
  std::vector<Case> cases;
  for (const Cause& cause : kCauses) {
    const std::vector<const char*> protocols = protocols_of(cause);
    cases.push_back({cause, protocols[cases.size() % protocols.size()]});
  }
  return cases;
}

std::vector<Case> each_cause_with_every_protocol() {
  std::vector<Case> cases;
  for (const Cause& cause : kCauses) {
    for (const char* protocol : protocols_of(cause)) cases.push_back({cause, protocol});
  }
  return cases;
}

class ResetWhileItRuns : public testing::TestWithParam<Case> {
 protected:
  /// Time of lock-step passes faster than the host sends: its silences may be longer.
  void start() {
    std::vector<std::string> robot = with_protocol(GetParam().protocol), controller = robot;
    robot.insert(robot.end(), {"--lockstep", "--once", "--fault", GetParam().cause.fault});
    controller.insert(controller.end(),
                      {"--lockstep", "--start", "walk@0.4", "--set", "supervisor.heartbeat_timeout_s=20",
                       "--set", "supervisor.operator_gone_s=600", "--set", "telemetry.release_s=60"});
    // By its void offset a joint may be beyond its travel: that would hold the reset up.
    if (refused())
      controller.insert(controller.end(), {"--set", "supervisor.position_margin_rad=" + widest()});
    run_.start_robot(robot);
    run_.start_controller(controller);
    ASSERT_TRUE(host_.until([&] { return host_.run_id != 0; })) << run_.said();
    host_.learn(telemetry::read_token(run_.file("token")).value());
    host_.alive = true;
  }

  void expect_found() {
    const Cause& cause = GetParam().cause;
    const auto bit = std::uint64_t{1} << static_cast<unsigned>(cause.latched);
    ASSERT_TRUE(host_.until([&] { return (host_.latched & bit) != 0; })) << run_.said();
    const std::string& found = host_.found[supervisor::name(cause.latched)];
    EXPECT_NE(found.find(cause.found), std::string::npos) << found;
  }

  [[nodiscard]] static bool refused() {
    const std::string_view protocol = GetParam().protocol;
    return GetParam().cause.silences && protocol != "mit_damiao" && protocol != "moteus";
  }

  /// What the frames of its drivers carry.
  [[nodiscard]] static std::string widest() {
    return std::string_view(GetParam().protocol) == "odrive" ? "3" : "0.7";
  }

  void expect_refusal() {
    ASSERT_EQ(host_.ask(CommandKind::stand), "accepted");
    const auto refusal = std::uint64_t{1} << static_cast<unsigned>(Fault::bring_up_failed);
    ASSERT_TRUE(host_.until([&] { return host_.latched != 0; })) << run_.said();
    EXPECT_EQ(host_.latched, refusal);
    EXPECT_NE(run_.said().find("cannot be brought up: its offset is void"), std::string::npos) << run_.said();
    run_.end_robot();
    run_.expect_both_to_end();
  }

  void stand_and_walk() {
    ASSERT_EQ(host_.ask(CommandKind::stand), "accepted");
    ASSERT_TRUE(host_.until([&] { return host_.state == State::stand && host_.ramp >= 1.0; })) << run_.said();
    ASSERT_EQ(host_.ask(CommandKind::walk, 0.4), "accepted");
    ASSERT_TRUE(host_.until_state(State::walk)) << run_.said();
    const double from_s = host_.time_s;
    ASSERT_TRUE(host_.until([&] { return host_.time_s > from_s + 4.0 || host_.state != State::walk; }));
    ASSERT_EQ(host_.state, State::walk) << run_.said();
  }

  /// Its reaction is that of the table, and nothing that latches came between reset and end.
  void expect_reactions(double reset_s, double end_s) {
    const supervisor::FaultRow& row = supervisor::row(GetParam().cause.latched);
    bool named = false;
    const nlohmann::json report = run_.controller_json();
    for (const nlohmann::json& fault : report.at("faults")) {
      const std::string reaction = fault.at("reaction");
      const std::string fault_name = fault.at("name");
      named = named || (fault_name == row.name && reaction == supervisor::name(row.reaction));
      const bool latches = reaction == "damp" || reaction == "sit";
      const double time_s = fault.at("time_s");
      EXPECT_TRUE(!latches || time_s < reset_s + 0.1 || time_s > end_s) << fault;
    }
    EXPECT_TRUE(named) << report.at("faults");
  }

  RobotAndController run_;
  Host host_;
};

TEST_P(ResetWhileItRuns, StandsAndWalksAgainOrIsRefused) {
  start();
  if (HasFatalFailure()) return;
  ASSERT_TRUE(host_.until_state(State::fault)) << run_.said();
  expect_found();
  if (HasFatalFailure()) return;
  const double fault_s = host_.time_s;
  ASSERT_TRUE(host_.until([&] { return host_.time_s > fault_s + 2.0; })) << "until the cause is gone";
  EXPECT_EQ(host_.state, State::fault) << "it waits for the reset";
  ASSERT_EQ(host_.ask(CommandKind::reset), "accepted");
  ASSERT_TRUE(host_.until_state(State::idle)) << run_.said();
  const double reset_s = host_.time_s;
  if (refused()) return expect_refusal();
  stand_and_walk();
  if (HasFatalFailure()) return;
  EXPECT_EQ(host_.latched, 0u);
  const double end_s = host_.time_s;
  run_.end_robot();  // the robot ends first, and says whether it was free
  run_.expect_both_to_end();
  EXPECT_EQ(run_.robot_json().at("gantry"), "off") << run_.said();
  expect_reactions(reset_s, end_s);
}

std::string test_name(const testing::TestParamInfo<Case>& row) { return name(row.param); }

INSTANTIATE_TEST_SUITE_P(TwoProcesses, ResetWhileItRuns, testing::ValuesIn(each_cause()), test_name);
// All of them: ctest -C long -R Recovery.over_dds
INSTANTIATE_TEST_SUITE_P(DISABLED_EveryProtocol, ResetWhileItRuns,
                         testing::ValuesIn(each_cause_with_every_protocol()), test_name);

}  // namespace
}  // namespace stilt::two_processes
