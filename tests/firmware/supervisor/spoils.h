#pragma once

#include <array>

#include "firmware/supervisor/detectors.h"
#include "firmware/supervisor/fault.h"

/// One cause of every fault, in the order of the table.
namespace stilt::supervisor::testing {

struct Spoil {
  Fault fault;
  void (*apply)(Observation&);  ///< to what a healthy robot shows
};

inline constexpr std::array<Spoil, kFaults> kSpoils = {{
    {Fault::joint_position_limit, [](Observation& o) { o.joints[0].position_rad = 3; }},
    {Fault::joint_speed_limit, [](Observation& o) { o.joints[0].velocity_rad_s = 40; }},
    {Fault::joint_torque_limit, [](Observation& o) { o.joints[0].torque_Nm = 140; }},
    {Fault::base_pitch_limit, [](Observation& o) { o.base.pitch_rad = 1; }},
    {Fault::encoder_frozen,
     [](Observation& o) {
       o.joints[0].unchanged_replies = 100;
       o.planned_speed_rad_s[0] = 2;
     }},
    {Fault::stale_torso_sensor, [](Observation& o) { o.base.missed_replies = 20; }},
    {Fault::missed_replies, [](Observation& o) { o.joints[0].missed_replies = 5; }},
    {Fault::lost_replies, [](Observation& o) { o.joints[0].missed_replies = 20; }},
    {Fault::bus_error, [](Observation& o) { o.bus_errors = true; }},
    {Fault::bus_off, [](Observation& o) { o.read_status = hal::JointBusStatus::bus_off; }},
    {Fault::bus_disconnected, [](Observation& o) { o.read_status = hal::JointBusStatus::disconnected; }},
    {Fault::driver_fault, [](Observation& o) { o.joints[0].fault = hal::DriverFault::encoder; }},
    {Fault::driver_not_enabled, [](Observation& o) { o.joints[0].state = hal::DriverState::idle; }},
    {Fault::driver_hot, [](Observation& o) { o.joints[0].motor_temperature_C = 80; }},
    {Fault::driver_overheated, [](Observation& o) { o.joints[0].motor_temperature_C = 120; }},
    {Fault::low_voltage, [](Observation& o) { o.joints[0].supply_V = 15; }},
    {Fault::high_voltage, [](Observation& o) { o.joints[0].supply_V = 70; }},
    {Fault::stale_plan, [](Observation& o) { o.followable.plan = PlanUse::none; }},
    {Fault::failed_solves, [](Observation& o) { o.failed_solves = 3; }},
    {Fault::planner_overrun, [](Observation& o) { o.solve_s = 0.02; }},
    {Fault::torque_loop_overrun, [](Observation& o) { o.wakeup_latency_s = 0.001; }},
    {Fault::torque_loop_stalled, [](Observation& o) { o.wakeup_latency_s = 0.02; }},
    {Fault::not_finite, [](Observation& o) { o.controller_finite = false; }},
    {Fault::heartbeat_lost,
     [](Observation& o) {
       o.heartbeat_expected = true;
       o.heartbeat_age_s = 1;
     }},
    {Fault::emergency_stop, [](Observation& o) { o.emergency_stop = hal::EmergencyStopState::pressed; }},
    {Fault::bring_up_failed, [](Observation& o) { o.bring_up_failed = true; }},
    {Fault::plan_missing, [](Observation& o) { o.followable = {.plan = PlanUse::none, .gait = true}; }},
    {Fault::planner_lost,
     [](Observation& o) {
       o.followable = {.plan = PlanUse::none, .gait = true};
       o.plan_age_s = 60;
     }},
    {Fault::operator_gone,
     [](Observation& o) {
       o.heartbeat_expected = true;
       o.heartbeat_age_s = 60;
     }},
    {Fault::following_error, [](Observation& o) { o.signals.following_error_rad[0] = 2; }},
    {Fault::hip_height_limit, [](Observation& o) { o.hip_height_share = 0.1; }},
    {Fault::encoder_jump, [](Observation& o) { o.signals.encoder_jump_rad[0] = 0.5; }},
    {Fault::torso_sensor_implausible, [](Observation& o) { o.signals.torso_mismatch_rad = -0.5; }},
    {Fault::torque_mismatch, [](Observation& o) { o.signals.torque_mismatch_Nm[0] = -60; }},
}};

}  // namespace stilt::supervisor::testing
