#include "firmware/supervisor/fault_detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/firmware/supervisor/observations.h"
#include "tests/firmware/supervisor/spoils.h"

namespace stilt::supervisor {
namespace {

using testing::healthy;
using testing::joint_limits;
using testing::kSpoils;
using testing::Spoil;

/// Limits that are all different numbers, and that the spoils cross.
SupervisorParameters different_limits() {
  return {.position_margin_rad = 0.15,
          .speed_margin_rad_s = 8,
          .torque_margin_Nm = 20,
          .base_pitch_limit_rad = 0.7,
          .hip_height_share = 0.6,
          .following_error_rad = 0.8,
          .encoder_jump_rad = 0.06,
          .torso_mismatch_rad = 0.05,
          .torque_mismatch_Nm = 9,
          .unchanged_replies_limit = 25,
          .missed_hold_ticks = 3,
          .missed_damp_ticks = 10,
          .hot_C = 75,
          .overheated_C = 90,
          .low_voltage_V = 36,
          .high_voltage_V = 56,
          .stale_plan_s = 0.25,
          .failed_solves = 2,
          .planner_overrun_s = 0.011,
          .torque_loop_overrun_s = 5e-4,
          .torque_loop_stall_s = 0.012,
          .planner_lost_s = 11,
          .heartbeat_timeout_s = 0.4,
          .operator_gone_s = 30};
}

/// All faults whose detail has a limit, with the limit there. Joint limits are those of joint_limits().
const std::map<Fault, double> kLimits = {
    {Fault::joint_position_limit, 1.6 + 0.15},
    {Fault::joint_speed_limit, 10 + 8},
    {Fault::joint_torque_limit, 80 + 20},
    {Fault::base_pitch_limit, 0.7},
    {Fault::encoder_frozen, 25},
    {Fault::stale_torso_sensor, 10},
    {Fault::missed_replies, 3},
    {Fault::lost_replies, 10},
    {Fault::driver_hot, 75},
    {Fault::driver_overheated, 90},
    {Fault::low_voltage, 36},
    {Fault::high_voltage, 56},
    {Fault::failed_solves, 2},
    {Fault::planner_overrun, 0.011},
    {Fault::torque_loop_overrun, 5e-4},
    {Fault::torque_loop_stalled, 0.012},
    {Fault::heartbeat_lost, 0.4},
    {Fault::planner_lost, 11},
    {Fault::operator_gone, 30},
    {Fault::following_error, 0.8},
    {Fault::hip_height_limit, 0.6},
    {Fault::encoder_jump, 0.06},
    {Fault::torso_sensor_implausible, 0.05},
    {Fault::torque_mismatch, 9},
};

TEST(FaultDetail, AValueHasCrossedTheLimitOfItsFault) {
  for (const Spoil& spoil : kSpoils) {
    SCOPED_TRACE(name(spoil.fault));
    Observation seen = healthy();
    spoil.apply(seen);
    const FaultDetail found = detail(spoil.fault, seen, joint_limits(), different_limits());
    const auto wanted = kLimits.find(spoil.fault);
    if (wanted == kLimits.end()) {
      EXPECT_TRUE(std::isnan(found.limit)) << found.limit;
      continue;
    }
    EXPECT_EQ(found.limit, wanted->second);
    const bool lower = spoil.fault == Fault::low_voltage || spoil.fault == Fault::hip_height_limit;
    EXPECT_TRUE(lower ? found.value < found.limit : std::abs(found.value) >= found.limit) << found.value;
    EXPECT_STRNE(found.unit, "");
  }
}

TEST(FaultDetail, TheJointIsTheOneThatIsSpoilt) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    Observation seen = healthy();
    seen.joints[joint].fault = hal::DriverFault::encoder;
    seen.joints[joint].fault_code = 0x2a;
    seen.joints[joint].motor_temperature_C = 96;
    seen.joints[joint].position_rad = -7;
    const auto of = [&](Fault fault) { return detail(fault, seen, joint_limits(), {}); };
    EXPECT_EQ(of(Fault::driver_fault).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::driver_fault).driver_fault, hal::DriverFault::encoder);
    EXPECT_EQ(of(Fault::driver_fault).fault_code, 0x2au);
    EXPECT_EQ(of(Fault::driver_overheated).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::driver_overheated).value, 96);
    EXPECT_EQ(of(Fault::driver_overheated).limit, SupervisorParameters{}.overheated_C);
    EXPECT_EQ(of(Fault::joint_position_limit).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::joint_position_limit).value, -7);
    EXPECT_LT(of(Fault::joint_position_limit).limit, 0.1);
  }
}

/// Only the bring-up has the cause of its failure; the control loop adds that.
TEST(FaultDetail, EveryFaultHasAJointOrABusOrAConditionOrANumber) {
  for (Spoil spoil : kSpoils) {
    if (spoil.fault == Fault::bring_up_failed) continue;
    Observation seen = healthy();
    spoil.apply(seen);
    seen.buses = {.off = 2, .gone = 4, .erring = 8};
    const FaultDetail found = detail(spoil.fault, seen, joint_limits(), {});
    EXPECT_TRUE(found.joint >= 0 || found.bus >= 0 || *found.condition != '\0' || !std::isnan(found.value))
        << name(spoil.fault);
  }
}

TEST(FaultDetail, TheBusIsTheFirstThatIsOffOrGoneOrErrs) {
  Observation seen = healthy();
  seen.buses = {.off = 0b1100, .gone = 0b1000, .erring = 0b0010};
  const auto bus = [&](Fault fault) { return detail(fault, seen, joint_limits(), {}).bus; };
  EXPECT_EQ(bus(Fault::bus_off), 2);
  EXPECT_EQ(bus(Fault::bus_disconnected), 3);
  EXPECT_EQ(bus(Fault::bus_error), 1);
  seen.buses = {};
  EXPECT_EQ(bus(Fault::bus_off), -1) << "a robot without buses";
  EXPECT_STREQ(detail(Fault::bus_error, seen, joint_limits(), {}).condition, "frames that cannot be decoded");
}

TEST(FaultDetail, AnEmergencyStopIsPressedOrSilent) {
  Observation seen = healthy();
  const auto condition = [&] { return detail(Fault::emergency_stop, seen, joint_limits(), {}).condition; };
  seen.emergency_stop = hal::EmergencyStopState::pressed;
  EXPECT_STREQ(condition(), "pressed");
  seen.emergency_stop = hal::EmergencyStopState::unknown;
  EXPECT_STREQ(condition(), "silent");
}

TEST(FaultDetail, ATorsoSensorIsSilentOrRepeatsOneValueEachWithItsOwnLimit) {
  const SupervisorParameters parameters;
  Observation seen = healthy();
  const auto found = [&] { return detail(Fault::stale_torso_sensor, seen, joint_limits(), parameters); };
  seen.base.unchanged_replies = 25;
  EXPECT_STREQ(found().condition, "repeats one value");
  EXPECT_EQ(found().value, 25);
  EXPECT_EQ(found().limit, parameters.unchanged_replies_limit);
  seen.base.missed_replies = 12;
  EXPECT_STREQ(found().condition, "silent");
  EXPECT_EQ(found().value, 12);
  EXPECT_EQ(found().limit, parameters.missed_damp_ticks);
}

TEST(FaultDetail, AMissingPlanIsTooOldOrNotInStep) {
  const SupervisorParameters parameters;
  for (const Fault fault : {Fault::stale_plan, Fault::plan_missing}) {
    Observation seen = healthy();
    seen.plan_age_s = parameters.stale_plan_s + 0.1;
    EXPECT_EQ(detail(fault, seen, joint_limits(), parameters).value, seen.plan_age_s);
    EXPECT_EQ(detail(fault, seen, joint_limits(), parameters).limit, parameters.stale_plan_s);
    seen.plan_age_s = 0.5 * parameters.stale_plan_s;
    EXPECT_STREQ(detail(fault, seen, joint_limits(), parameters).condition, "not in step");
  }
}

TEST(FaultDetail, WhatIsNotFiniteIsNamed) {
  const auto found = [](const Observation& seen) {
    return detail(Fault::not_finite, seen, joint_limits(), {});
  };
  Observation seen = healthy();
  EXPECT_STREQ(found(seen).condition, "estimate or torque not a number");
  seen.base.pitch_rate_rad_s = NAN;
  EXPECT_STREQ(found(seen).condition, "torso sensor not a number");
  seen.joints[2].velocity_rad_s = NAN;
  EXPECT_EQ(found(seen).joint, 2);
  EXPECT_STREQ(found(seen).condition, "reading not a number");
  seen.write_status = hal::JointBusStatus::refused;
  EXPECT_STREQ(found(seen).condition, "command refused");
}

TEST(FaultDetail, HeatIsOfTheMotorOrOfItsDriver) {
  Observation seen = healthy();
  seen.joints[3].driver_temperature_C = 96;
  EXPECT_STREQ(detail(Fault::driver_overheated, seen, joint_limits(), {}).condition, "driver");
  seen = healthy();
  seen.joints[3].motor_temperature_C = 96;
  EXPECT_STREQ(detail(Fault::driver_overheated, seen, joint_limits(), {}).condition, "motor");
}

TEST(FaultDetail, TheLimitOfAMissingTorqueIsTheLargerOfTheTwo) {
  Observation seen = healthy();
  seen.signals.asked_torque_Nm[2] = 50;
  seen.signals.torque_mismatch_Nm[2] = -31;
  EXPECT_EQ(detail(Fault::torque_mismatch, seen, joint_limits(), {}).limit, 30);
  seen.signals.asked_torque_Nm[2] = 5;
  EXPECT_EQ(detail(Fault::torque_mismatch, seen, joint_limits(), {}).limit,
            SupervisorParameters{}.torque_mismatch_Nm);
}

}  // namespace
}  // namespace stilt::supervisor
