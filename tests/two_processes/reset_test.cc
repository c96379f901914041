// A fault while the robot walks, its cause gone, a reset over DDS: the robot stands up and walks again, with
// the same stiltd. In lock-step; the gantry lifts the robot after its fall.
#include <gtest/gtest.h>

#include <csignal>
#include <map>

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

struct Cause {
  const char* name;  ///< of the test
  const char* protocol;
  const char* fault;  ///< option of the robot; its cause goes by itself, or with the reset
  Fault latched;
  const char* found;  ///< part of what the message of the supervisor says about it
};

void PrintTo(const Cause& cause, std::ostream* out) { *out << cause.protocol << ", " << cause.fault; }

class ResetWhileItRuns : public testing::TestWithParam<Cause> {
 protected:
  void start() {
    std::vector<std::string> robot = with_protocol(GetParam().protocol), controller = robot;
    robot.insert(robot.end(), {"--lockstep", "--once", "--fault", GetParam().fault});
    controller.insert(controller.end(),
                      {"--lockstep", "--start", "walk@0.4", "--set", "supervisor.heartbeat_timeout_s=20",
                       "--set", "supervisor.operator_gone_s=600", "--set", "telemetry.release_s=600"});
    run_.start_robot(robot);
    run_.start_controller(controller);
    ASSERT_TRUE(host_.until([&] { return host_.run_id != 0; })) << run_.said();
    host_.learn(telemetry::read_token(run_.file("token")).value());
    host_.alive = true;
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

  RobotAndController run_;
  Host host_;
};

TEST_P(ResetWhileItRuns, StandsAndWalksAgain) {
  const Cause& cause = GetParam();
  start();
  if (HasFatalFailure()) return;
  ASSERT_TRUE(host_.until_state(State::fault)) << run_.said();
  const auto bit = std::uint64_t{1} << static_cast<unsigned>(cause.latched);
  ASSERT_TRUE(host_.until([&] { return (host_.latched & bit) != 0; })) << run_.said();
  EXPECT_NE(host_.found[supervisor::name(cause.latched)].find(cause.found), std::string::npos)
      << host_.found[supervisor::name(cause.latched)];
  // Until the cause is over; what a driver keeps is cleared by the reset.
  const double fault_s = host_.time_s;
  ASSERT_TRUE(host_.until([&] { return host_.time_s > fault_s + 2.0; }));
  EXPECT_EQ(host_.state, State::fault) << "it waits for the reset";
  ASSERT_EQ(host_.ask(CommandKind::reset), "accepted");
  ASSERT_TRUE(host_.until_state(State::idle)) << run_.said();
  const double reset_s = host_.time_s;
  stand_and_walk();
  if (HasFatalFailure()) return;
  EXPECT_EQ(host_.latched, 0u);
  run_.robot().signal(SIGINT);  // the robot ends first, and says whether it was free
  run_.expect_both_to_end();
  EXPECT_EQ(run_.robot_json().at("gantry"), "off") << run_.said();
  for (const nlohmann::json& fault : run_.controller_json().at("faults")) {
    const bool end = fault.at("name") == "bus_disconnected";
    const bool latches = fault.at("reaction") == "damp" || fault.at("reaction") == "sit";
    EXPECT_TRUE(!latches || end || fault.at("time_s") < reset_s + 0.1) << fault;
  }
}

INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, ResetWhileItRuns,
    testing::Values(
        Cause{"DamiaoDriverFault", "mit_damiao", "driver-fault:knee_L@2", Fault::driver_fault, "knee_L, "},
        Cause{"DamiaoEmergencyStop", "mit_damiao", "emergency-stop@2+1", Fault::emergency_stop, "pressed"},
        Cause{"MoteusDriverFault", "moteus", "driver-fault:hip_R@2", Fault::driver_fault, "hip_R, "},
        Cause{"MoteusBusOff", "moteus", "bus-off:1@2+0.2", Fault::bus_off, "bus 1"},
        Cause{"OdrivePowerCycle", "odrive", "power-cycle@2", Fault::lost_replies, "limit 10 ticks"},
        Cause{"AkSilentTorsoSensor", "mit_ak", "base-silent@2+1", Fault::stale_torso_sensor, "silent"}),
    [](const testing::TestParamInfo<Cause>& row) { return row.param.name; });

}  // namespace
}  // namespace stilt::two_processes
