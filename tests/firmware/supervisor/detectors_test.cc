#include "firmware/supervisor/detectors.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/firmware/supervisor/observations.h"

namespace stilt::supervisor {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const SupervisorParameters kParameters;

FaultSet faults_of(const Observation& seen) { return detect(seen, testing::joint_limits(), kParameters); }

TEST(Detectors, AHealthyRobotHasNoFault) { EXPECT_EQ(faults_of(testing::healthy()), FaultSet()); }

TEST(Detectors, WhatADriverDoesNotReportIsNoFault) {
  Observation seen = testing::healthy();
  for (hal::JointReading& joint : seen.joints) {
    joint.torque_Nm = joint.driver_temperature_C = joint.motor_temperature_C = joint.supply_V = kNan;
    joint.state = hal::DriverState::unknown;
  }
  EXPECT_EQ(faults_of(seen), FaultSet());
}

/// One thing out of order, the value on either side of its limit, and the faults it must give, and no other.
struct Case {
  const char* name;
  std::function<void(Observation&)> inside;
  std::function<void(Observation&)> outside;
  std::vector<Fault> expected;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"position above",
       [](Observation& o) { o.joints[0].position_rad = 1.74; },
       [](Observation& o) { o.joints[0].position_rad = 1.76; },
       {Fault::joint_position_limit}},
      {"position below",
       [](Observation& o) { o.joints[3].position_rad = -0.14; },
       [](Observation& o) { o.joints[3].position_rad = -0.16; },
       {Fault::joint_position_limit}},
      {"position not a number",
       [](Observation&) {},
       [](Observation& o) { o.joints[2].position_rad = kNan; },
       {Fault::joint_position_limit}},
      {"speed",
       [](Observation& o) { o.joints[1].velocity_rad_s = -17.9; },
       [](Observation& o) { o.joints[1].velocity_rad_s = -18.1; },
       {Fault::joint_speed_limit}},
      {"speed infinite",
       [](Observation&) {},
       [](Observation& o) { o.joints[1].velocity_rad_s = kInfinity; },
       {Fault::joint_speed_limit}},
      {"torque",
       [](Observation& o) { o.joints[1].torque_Nm = -99; },
       [](Observation& o) { o.joints[1].torque_Nm = -101; },
       {Fault::joint_torque_limit}},
      {"lean forward",
       [](Observation& o) { o.base.pitch_rad = 0.79; },
       [](Observation& o) { o.base.pitch_rad = 0.81; },
       {Fault::base_pitch_limit}},
      {"lean backward",
       [](Observation& o) { o.base.pitch_rad = -0.79; },
       [](Observation& o) { o.base.pitch_rad = -0.81; },
       {Fault::base_pitch_limit}},
      {"pitch not a number",
       [](Observation&) {},
       [](Observation& o) { o.base.pitch_rad = kNan; },
       {Fault::base_pitch_limit}},
      {"encoder repeats while moving",
       [](Observation& o) {
         o.joints[2].unchanged_replies = 24;
         o.planned_speed_rad_s[2] = 2;
       },
       [](Observation& o) {
         o.joints[2].unchanged_replies = 25;
         o.planned_speed_rad_s[2] = -2;
       },
       {Fault::encoder_frozen}},
      {"encoder repeats while standing",
       [](Observation& o) { o.joints[2].unchanged_replies = 5000; },
       [](Observation& o) {
         o.joints[2].unchanged_replies = 5000;
         o.planned_speed_rad_s[2] = 0.6;
       },
       {Fault::encoder_frozen}},
      {"torso sensor repeats",
       [](Observation& o) { o.base.unchanged_replies = 5000; },
       [](Observation& o) {
         o.base.unchanged_replies = 25;
         o.planned_speed_rad_s[0] = 0.6;
       },
       {Fault::stale_torso_sensor}},
      {"base held still while joints move outside of any plan",
       [](Observation& o) {
         o.base.unchanged_replies = 5000;
         o.joints[0].velocity_rad_s = 0.6;
       },
       [](Observation& o) {
         o.base.unchanged_replies = 5000;
         o.planned_speed_rad_s[1] = -0.6;
       },
       {Fault::stale_torso_sensor}},
      {"torso sensor late",
       [](Observation& o) { o.base.missed_replies = 2; },
       [](Observation& o) { o.base.missed_replies = 3; },
       {Fault::missed_replies}},
      {"torso sensor silent",
       [](Observation&) {},
       [](Observation& o) { o.base.missed_replies = 10; },
       {Fault::missed_replies, Fault::stale_torso_sensor}},
      {"three replies missed",
       [](Observation& o) { o.joints[1].missed_replies = 2; },
       [](Observation& o) { o.joints[1].missed_replies = 3; },
       {Fault::missed_replies}},
      {"ten replies missed",
       [](Observation&) {},
       [](Observation& o) { o.joints[1].missed_replies = 10; },
       {Fault::missed_replies, Fault::lost_replies}},
      {"bus errors", [](Observation&) {}, [](Observation& o) { o.bus_errors = true; }, {Fault::bus_error}},
      {"bus off while reading",
       [](Observation& o) { o.read_status = hal::JointBusStatus::incomplete; },
       [](Observation& o) { o.read_status = hal::JointBusStatus::bus_off; },
       {Fault::bus_off}},
      {"bus off while writing",
       [](Observation&) {},
       [](Observation& o) { o.write_status = hal::JointBusStatus::bus_off; },
       {Fault::bus_off}},
      {"bus gone",
       [](Observation&) {},
       [](Observation& o) { o.read_status = hal::JointBusStatus::disconnected; },
       {Fault::bus_disconnected}},
      {"driver fault",
       [](Observation&) {},
       [](Observation& o) { o.joints[3].fault = hal::DriverFault::over_current; },
       {Fault::driver_fault}},
      {"driver in fault state",
       [](Observation&) {},
       [](Observation& o) { o.joints[3].state = hal::DriverState::fault; },
       {Fault::driver_fault}},
      {"driver idle",
       [](Observation& o) { o.joints[3].state = hal::DriverState::unknown; },
       [](Observation& o) { o.joints[3].state = hal::DriverState::idle; },
       {Fault::driver_not_enabled}},
      {"driver hot",
       [](Observation& o) { o.joints[0].driver_temperature_C = 74; },
       [](Observation& o) { o.joints[0].driver_temperature_C = 76; },
       {Fault::driver_hot}},
      {"motor too hot",
       [](Observation& o) { o.joints[0].motor_temperature_C = 74; },
       [](Observation& o) { o.joints[0].motor_temperature_C = 91; },
       {Fault::driver_hot, Fault::driver_overheated}},
      {"low voltage",
       [](Observation& o) { o.joints[0].supply_V = 36.1; },
       [](Observation& o) { o.joints[0].supply_V = 35.9; },
       {Fault::low_voltage}},
      {"high voltage",
       [](Observation& o) { o.joints[0].supply_V = 55.9; },
       [](Observation& o) { o.joints[0].supply_V = 56.1; },
       {Fault::high_voltage}},
      {"far from the plan",
       [](Observation& o) { o.signals.following_error_rad[1] = 0.79; },
       [](Observation& o) { o.signals.following_error_rad[1] = 0.81; },
       {Fault::following_error}},
      {"legs fold",
       [](Observation& o) { o.hip_height_share = 0.51; },
       [](Observation& o) { o.hip_height_share = 0.49; },
       {Fault::hip_height_limit}},
      {"hip height not a number",
       [](Observation&) {},
       [](Observation& o) { o.hip_height_share = kNan; },
       {Fault::hip_height_limit}},
      {"encoder jumps",
       [](Observation& o) { o.signals.encoder_jump_rad[2] = 0.049; },
       [](Observation& o) { o.signals.encoder_jump_rad[2] = 0.051; },
       {Fault::encoder_jump}},
      {"torso sensor contradicts itself",
       [](Observation& o) { o.signals.torso_mismatch_rad = -0.049; },
       [](Observation& o) { o.signals.torso_mismatch_rad = -0.051; },
       {Fault::torso_sensor_implausible}},
      {"torque missing",
       [](Observation& o) { o.signals.torque_mismatch_Nm[3] = -9.9; },
       [](Observation& o) { o.signals.torque_mismatch_Nm[3] = -10.1; },
       {Fault::torque_mismatch}},
      {"torque of a fast motor",
       [](Observation& o) {
         o.signals.torque_mismatch_Nm[3] = -29;
         o.signals.asked_torque_Nm[3] = 50;
       },
       [](Observation& o) {
         o.signals.torque_mismatch_Nm[3] = 31;
         o.signals.asked_torque_Nm[3] = 50;
       },
       {Fault::torque_mismatch}},
      {"no plan",
       [](Observation& o) { o.followable.plan = PlanUse::with_feedback; },
       [](Observation& o) { o.followable.plan = PlanUse::none; },
       {Fault::stale_plan}},
      {"no plan but a gait",
       [](Observation& o) { o.followable = {.plan = PlanUse::none, .gait = true, .gait_selected = true}; },
       [](Observation& o) { o.followable = {.plan = PlanUse::none, .gait = true}; },
       {Fault::plan_missing}},
      {"no plan for long",
       [](Observation& o) {
         o.followable = {.plan = PlanUse::none, .gait = true, .gait_selected = true};
         o.plan_age_s = 60;
       },
       [](Observation& o) {
         o.followable = {.plan = PlanUse::none, .gait = true};
         o.plan_age_s = 10.1;
       },
       {Fault::plan_missing, Fault::planner_lost}},
      {"solves fail",
       [](Observation& o) { o.failed_solves = 2; },
       [](Observation& o) { o.failed_solves = 3; },
       {Fault::failed_solves}},
      {"solve slow",
       [](Observation& o) { o.solve_s = 0.0099; },
       [](Observation& o) { o.solve_s = 0.0101; },
       {Fault::planner_overrun}},
      {"tick late",
       [](Observation& o) { o.wakeup_latency_s = 4.9e-4; },
       [](Observation& o) { o.wakeup_latency_s = 5.1e-4; },
       {Fault::torque_loop_overrun}},
      {"torque loop stood still",
       [](Observation&) {},
       [](Observation& o) { o.wakeup_latency_s = 0.011; },
       {Fault::torque_loop_overrun, Fault::torque_loop_stalled}},
      {"torque loop stood still inside a tick",
       [](Observation& o) { o.tick_gap_s = 0.0099; },
       [](Observation& o) { o.tick_gap_s = 0.0101; },
       {Fault::torque_loop_stalled}},
      {"estimate not finite",
       [](Observation&) {},
       [](Observation& o) { o.controller_finite = false; },
       {Fault::not_finite}},
      {"command refused",
       [](Observation&) {},
       [](Observation& o) { o.write_status = hal::JointBusStatus::refused; },
       {Fault::not_finite}},
      {"heartbeat",
       [](Observation& o) {
         o.heartbeat_expected = true;
         o.heartbeat_age_s = 0.39;
       },
       [](Observation& o) {
         o.heartbeat_expected = true;
         o.heartbeat_age_s = 0.41;
       },
       {Fault::heartbeat_lost}},
      {"heartbeat silent for long",
       [](Observation& o) {
         o.heartbeat_expected = true;
         o.heartbeat_age_s = 0.39;
       },
       [](Observation& o) {
         o.heartbeat_expected = true;
         o.heartbeat_age_s = 30.1;
       },
       {Fault::heartbeat_lost, Fault::operator_gone}},
      {"heartbeat not expected",
       [](Observation& o) { o.heartbeat_age_s = 1e9; },
       [](Observation& o) {
         o.heartbeat_expected = true;
         o.heartbeat_age_s = kNan;
       },
       {Fault::heartbeat_lost}},
      {"emergency stop pressed",
       [](Observation& o) { o.emergency_stop = hal::EmergencyStopState::absent; },
       [](Observation& o) { o.emergency_stop = hal::EmergencyStopState::pressed; },
       {Fault::emergency_stop}},
      {"emergency stop silent",
       [](Observation&) {},
       [](Observation& o) { o.emergency_stop = hal::EmergencyStopState::unknown; },
       {Fault::emergency_stop}},
      {"bring-up",
       [](Observation&) {},
       [](Observation& o) { o.bring_up_failed = true; },
       {Fault::bring_up_failed}},
  };
  return all;
}

TEST(Detectors, InsideItsLimitNothingIsAFault) {
  for (const Case& one : cases()) {
    Observation seen = testing::healthy();
    one.inside(seen);
    EXPECT_EQ(faults_of(seen), FaultSet()) << one.name;
  }
}

TEST(Detectors, OutsideItsLimitEachThingGivesItsFaultsAndNoOther) {
  for (const Case& one : cases()) {
    Observation seen = testing::healthy();
    one.outside(seen);
    FaultSet expected;
    for (const Fault fault : one.expected) expected.add(fault);
    EXPECT_EQ(faults_of(seen), expected) << one.name;
  }
}

TEST(Detectors, EveryFaultOfTheTableCanBeDetected) {
  FaultSet found;
  for (const Case& one : cases()) {
    Observation seen = testing::healthy();
    one.outside(seen);
    found = found | faults_of(seen);
  }
  EXPECT_EQ(found.count(), static_cast<int>(kFaults)) << ::testing::PrintToString(found);
}

TEST(Detectors, AJointThatNeverAnsweredIsAMatterOfItsReplies) {
  Observation seen = testing::healthy();
  seen.joints[1] = hal::JointReading{};
  seen.joints[1].missed_replies = 100;
  FaultSet expected;
  expected.add(Fault::missed_replies);
  expected.add(Fault::lost_replies);
  EXPECT_EQ(faults_of(seen), expected);
}

}  // namespace
}  // namespace stilt::supervisor
