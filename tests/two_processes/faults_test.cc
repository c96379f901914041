// Each fault of the table is injected into a walking robot. The named reaction comes within its deadline, and
// nothing but damping follows a fault that latches. In lock-step, so that a deadline counts ticks and not the
// machine's speed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/configuration/configuration.h"
#include "tests/two_processes/frame_record.h"
#include "tests/two_processes/protocols.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using hal::mit::MitSpecial;

constexpr double kTick_s = 0.001;

/// What a fault of the robot must lead to.
struct Expectation {
  const char* name;      ///< of the test
  const char* fault;     ///< option of the robot
  const char* detected;  ///< name in the controller's report; empty: none need be
  const char* reaction;
  int deadline_ticks;  ///< from the fault to its detection
};

void PrintTo(const Expectation& row, std::ostream* out) { *out << row.fault; }

/// A run with a fault 4 s after the gantry has released the robot, in the middle of walking.
class FaultWhileWalking : public testing::TestWithParam<Expectation> {
 protected:
  void run(const std::string& fault, const char* duration_s = "8") {
    run_.start_robot({"--lockstep", "--once", "--fault", fault});
    run_.start_controller({"--lockstep", "--start", "walk@0.5", "--duration", duration_s});
    run_.expect_both_to_end();
    if (HasFailure()) return;
    ASSERT_EQ(run_.robot_json().at("faults").size(), 1u) << run_.said();
    injected_s_ = run_.robot_json().at("faults")[0].at("robot_time_s");
    const configuration::Result shipped = configuration::load_robot("amber3m");
    ASSERT_TRUE(shipped);
    configuration_ = *shipped;
    traffic_ =
        motor_traffic(read_frames(run_.file("frames")), configuration::robot_wiring(configuration_.hardware));
  }

  /// First entry of the controller's report with this name and reaction.
  [[nodiscard]] std::optional<double> detected_s(const std::string& name, const std::string& reaction) const {
    const nlohmann::json report = run_.controller_json();
    for (const nlohmann::json& fault : report.at("faults")) {
      if (fault.at("name") == name && fault.at("reaction") == reaction) {
        return fault.at("time_s").get<double>();
      }
    }
    return std::nullopt;
  }

  /// After this time the drivers are asked for damping, or disabled, and for nothing else.
  void expect_only_damping(double from_s) const {
    const auto& supervisor = configuration_.supervisor;
    const auto from = static_cast<std::uint64_t>(std::llround(from_s / kTick_s)) + 1;
    std::size_t damped = 0;
    for (const MotorTraffic::Command& command : traffic_.commands) {
      if (command.tick < from) continue;
      ++damped;
      ASSERT_LT(command.asked.kp_Nm_rad, kKpStep_Nm_rad) << "tick " << command.tick;
      ASSERT_LT(std::abs(command.asked.torque_Nm), kTorqueStep_Nm) << "tick " << command.tick;
      ASSERT_LE(command.asked.kd_Nms_rad, supervisor.damping_kd_Nms_rad + 0.01) << "tick " << command.tick;
    }
    EXPECT_GT(damped, 100u);
    for (const MotorTraffic::Special& special : traffic_.specials) {
      if (special.tick < from) continue;
      EXPECT_EQ(special.what, MitSpecial::leave) << "nothing enables a motor";
    }
  }

  /// After this time the motors give damping's torque at most, as they report themselves.
  void expect_bounded_torque(double from_s) const {
    const auto from = static_cast<std::uint64_t>(std::llround(from_s / kTick_s)) + 2;
    const double bound_Nm = configuration_.supervisor.damping_torque_Nm + kTorqueSlack_Nm;
    for (const MotorTraffic::Reply& reply : traffic_.replies) {
      if (reply.tick < from) continue;
      ASSERT_LE(std::abs(reply.said.torque_Nm), bound_Nm)
          << "tick " << reply.tick << " joint " << reply.joint;
    }
  }

  RobotAndController run_;
  configuration::Configuration configuration_;
  MotorTraffic traffic_;
  double injected_s_ = 0;

 private:
  static constexpr double kKpStep_Nm_rad = 0.13;  // one step of 12 bits
  static constexpr double kTorqueStep_Nm = 0.06;
  static constexpr double kTorqueSlack_Nm = 5.0;  // the joint moves on between reading and command
};

class LatchedFault : public FaultWhileWalking {};

TEST_P(LatchedFault, IsNamedInTimeAndThenThereIsOnlyDamping) {
  const Expectation& row = GetParam();
  run(row.fault);
  if (HasFailure()) return;
  const std::optional<double> detected = detected_s(row.detected, row.reaction);
  ASSERT_TRUE(detected) << run_.controller_json().at("faults");
  EXPECT_GT(*detected, injected_s_);
  EXPECT_LE(*detected, injected_s_ + (row.deadline_ticks + 0.5) * kTick_s);
  expect_only_damping(*detected);
  const bool replies_are_true = !std::string_view(row.fault).starts_with("corrupt");
  if (replies_are_true) expect_bounded_torque(*detected);
  EXPECT_EQ(run_.controller().wait(0), 1) << "a fault stopped it";
}

std::string test_name(const testing::TestParamInfo<Expectation>& row) { return row.param.name; }

// Deadlines: the ticks of silence or repetition the supervisor's configuration allows, two for the way. The
// encoder freezes while its knee moves: one that rests hides it, here for up to 0.2 s of a step.
INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, LatchedFault,
    testing::Values(Expectation{"SilentJoint", "drop:knee_L@4", "lost_replies", "damp", 12},
                    Expectation{"SilentBus", "drop:1@4", "lost_replies", "damp", 12},
                    Expectation{"CorruptFrames", "corrupt@4", "torso_sensor_implausible", "damp", 20},
                    Expectation{"BusOff", "bus-off:1@4", "bus_off", "damp", 2},
                    Expectation{"BusOffThatRestarts", "bus-off:1@4+0.1", "bus_off", "damp", 2},
                    Expectation{"DriverFault", "driver-fault:hip_R@4", "driver_fault", "damp", 2},
                    Expectation{"TorqueLost", "torque-loss@4", "torque_mismatch", "damp", 400},
                    Expectation{"FrozenEncoder", "encoder-freeze@4.3", "encoder_frozen", "damp", 40},
                    Expectation{"PowerCycle", "power-cycle@4", "lost_replies", "damp", 12},
                    Expectation{"PowerThatReturns", "power-cycle@4+0.1", "driver_not_enabled", "damp", 105},
                    Expectation{"LowVoltage", "low-voltage@4", "driver_fault", "damp", 2},
                    Expectation{"EmergencyStop", "emergency-stop@4", "emergency_stop", "damp", 2},
                    Expectation{"SilentTorsoSensor", "base-silent@4", "stale_torso_sensor", "damp", 12},
                    Expectation{"FrozenTorsoSensor", "base-freeze@4", "stale_torso_sensor", "damp", 40}),
    test_name);

class PassingFault : public FaultWhileWalking {};

TEST_P(PassingFault, DoesNotEndTheWalk) {
  const Expectation& row = GetParam();
  run(row.fault);
  if (HasFailure()) return;
  EXPECT_TRUE(run_.robot_json().at("survived")) << run_.said();
  EXPECT_EQ(run_.controller().wait(0), 0) << run_.controller_json().at("faults");
  if (row.detected[0] != '\0') {
    const std::optional<double> detected = detected_s(row.detected, row.reaction);
    ASSERT_TRUE(detected) << run_.controller_json().at("faults");
    EXPECT_LE(*detected, injected_s_ + (row.deadline_ticks + 0.5) * kTick_s);
  }
}

INSTANTIATE_TEST_SUITE_P(
    TwoProcesses, PassingFault,
    testing::Values(Expectation{"FiveLostTicks", "drop:knee_L@4+0.005", "missed_replies", "hold", 5},
                    Expectation{"LateFrames", "delay@4+0.5", "missed_replies", "hold", 5},
                    Expectation{"DoubledFrames", "duplicate@4", "", "", 0}),
    test_name);

/// Steps to a stand, sits down upright, and only then is damped, all within the time of the fault table.
TEST_F(FaultWhileWalking, AnOverheatedMotorMakesItStandAndSitDownAndThenThereIsOnlyDamping) {
  run("over-temperature:hip_L@4", "11");
  if (HasFailure()) return;
  const std::optional<double> detected = detected_s("driver_overheated", "sit");
  ASSERT_TRUE(detected) << run_.controller_json().at("faults");
  EXPECT_LE(*detected, injected_s_ + 2.5 * kTick_s);
  EXPECT_TRUE(run_.robot_json().at("survived")) << run_.said();
  EXPECT_FALSE(run_.robot_json().at("sat_down_s").is_null()) << "it did not fall, it sat down\n"
                                                             << run_.said();
  const auto& supervisor = configuration_.supervisor;
  expect_only_damping(*detected + 2 * supervisor.slow_down_s + supervisor.sit_s + 4 * kTick_s);
}

/// Its start frame comes in the read of a status, or in one between two of them.
TEST(TwoProcesses, AnAkOfVersionThreeThatStartsAgainIsDampedWithTheReadOfItsStart) {
  constexpr double kOff_s = 0.004;
  for (const char* since : {"2.0", "2.001"}) {
    RobotAndController run;
    std::vector<std::string> robot = with_protocol("ak_v3"), controller = robot;
    robot.insert(robot.end(),
                 {"--lockstep", "--once", "--fault", std::string("power-cycle:hip_L@") + since + "+0.004"});
    controller.insert(controller.end(), {"--lockstep", "--start", "stand", "--duration", "4"});
    run.start_robot(robot);
    run.start_controller(controller);
    run.expect_both_to_end();
    ASSERT_EQ(run.robot_json().at("faults").size(), 1u) << run.said();
    const double powered_s = run.robot_json().at("faults")[0].at("robot_time_s").get<double>() + kOff_s;
    const nlohmann::json faults = run.controller_json().at("faults");
    const auto found = std::ranges::find(faults, "driver_not_enabled",
                                         [](const nlohmann::json& fault) { return fault.at("name"); });
    ASSERT_NE(found, faults.end()) << since << faults;
    EXPECT_EQ(found->at("reaction"), "damp") << faults;
    EXPECT_EQ(found->at("joint"), "hip_L") << faults;
    EXPECT_LE(found->at("time_s").get<double>(), powered_s + 2.5 * kTick_s) << faults;
  }
}

}  // namespace
}  // namespace stilt::two_processes
