#include "firmware/configuration/schema_fields.h"
#include "firmware/configuration/schema_tables.h"

namespace stilt::configuration {
namespace {

using namespace fields;
using P = Parameters;
using S = supervisor::SupervisorParameters;

constexpr Section kSections[] = {
    {"supervisor",
     "When the supervisor calls something a fault, and what it commands by itself. Limits of the joints are\n"
     "those of the robot; here are the margins beyond them."}};

constexpr Entry kEntries[] = {
    {"supervisor", "position_margin_rad", "rad", "Travel beyond the robot's before joint_position_limit",
     real<&P::supervisor, &S::position_margin_rad>(0.0, 3.0)},
    {"supervisor", "speed_margin_rad_s", "rad/s", "Speed beyond the robot's before joint_speed_limit",
     real<&P::supervisor, &S::speed_margin_rad_s>(0.0, 1000.0)},
    {"supervisor", "torque_margin_Nm", "Nm",
     "Torque that a driver reports beyond the robot's limit before joint_torque_limit",
     real<&P::supervisor, &S::torque_margin_Nm>(0.0, 1000.0)},
    {"supervisor", "base_angle_limit_rad", "rad", "Lean of the torso, either way, before base_angle_limit",
     real<&P::supervisor, &S::base_angle_limit_rad>(0.1, 3.2)},
    {"supervisor", "unchanged_replies_limit", "1",
     "Unchanged replies in a row from something that must move before encoder_frozen or stale_torso_sensor",
     integer<&P::supervisor, &S::unchanged_replies_limit>(2, 100000)},
    {"supervisor", "moving_rad_s", "rad/s",
     "A joint planned to be faster than this must move, and the base with it",
     real<&P::supervisor, &S::moving_rad_s>(0.0, 1000.0)},
    {"supervisor", "missed_hold_ticks", "1", "Missed replies in a row before the pose is held",
     integer<&P::supervisor, &S::missed_hold_ticks>(1, 1000)},
    {"supervisor", "missed_damp_ticks", "1", "Missed replies in a row before the joints are damped",
     integer<&P::supervisor, &S::missed_damp_ticks>(1, 1000)},
    {"supervisor", "settle_s", "s", "Time after the drivers came up before their replies are expected",
     real<&P::supervisor, &S::settle_s>(0.0, 10.0)},
    {"supervisor", "hot_C", "degC", "Temperature of driver or motor that is reported",
     real<&P::supervisor, &S::hot_C>(0.0, 300.0)},
    {"supervisor", "overheated_C", "degC", "Temperature of driver or motor at which the robot sits down",
     real<&P::supervisor, &S::overheated_C>(0.0, 300.0)},
    {"supervisor", "low_voltage_V", "V", "Supply voltage below which the robot sits down",
     real<&P::supervisor, &S::low_voltage_V>(0.0, 1000.0)},
    {"supervisor", "high_voltage_V", "V", "Supply voltage above which the joints are damped",
     real<&P::supervisor, &S::high_voltage_V>(0.0, 1000.0)},
    {"supervisor", "plan_feedback_after_s", "s",
     "Age of a plan from which its feedback gains correct its inputs",
     real<&P::supervisor, &S::plan_feedback_after_s>(0.0, 10.0)},
    {"supervisor", "stale_plan_s", "s", "Age from which a plan is not followed any more",
     real<&P::supervisor, &S::stale_plan_s>(0.001, 10.0)},
    {"supervisor", "track_gait", "",
     "Without a plan to follow the joints track a gait, where gaits of the robot are shipped",
     flag<&P::supervisor, &S::track_gait>()},
    {"supervisor", "select_gait", "",
     "Prefer the gait to plans: after a touch-down the joints track it, and plans are not followed",
     flag<&P::supervisor, &S::select_gait>()},
    {"supervisor", "select_gait_after_s", "s", "But not before the robot has stepped for so long",
     real<&P::supervisor, &S::select_gait_after_s>(0.0, 60.0)},
    {"supervisor", "failed_solves", "1", "Solves in a row without a plan that are reported",
     integer<&P::supervisor, &S::failed_solves>(1, 1000)},
    {"supervisor", "planner_overrun_s", "s", "Duration of a solve that is reported",
     real<&P::supervisor, &S::planner_overrun_s>(1e-05, 10.0)},
    {"supervisor", "torque_loop_overrun_s", "s", "Lateness of a tick that is reported",
     real<&P::supervisor, &S::torque_loop_overrun_s>(1e-06, 10.0)},
    {"supervisor", "torque_loop_stall_s", "s",
     "Time between two ticks, or lateness of one, after which the joints are damped",
     real<&P::supervisor, &S::torque_loop_stall_s>(0.0001, 10.0)},
    {"supervisor", "planner_lost_s", "s", "Time on a gait without a plan after which the robot sits",
     real<&P::supervisor, &S::planner_lost_s>(0.5, 1e6)},
    {"supervisor", "heartbeat_timeout_s", "s", "Silence of the operator's program after which walking ends",
     real<&P::supervisor, &S::heartbeat_timeout_s>(0.01, 60.0)},
    {"supervisor", "operator_gone_s", "s", "Silence of the operator's program after which the robot sits",
     real<&P::supervisor, &S::operator_gone_s>(1.0, 1e6)},
    {"supervisor", "emergency_stop_wait_s", "s", "Time after the start for the emergency stop's first report",
     real<&P::supervisor, &S::emergency_stop_wait_s>(0.0, 60.0)},
    {"supervisor", "emergency_stop_damps_s", "s",
     "Time after an emergency stop in which the joints are damped; then the motors are off",
     real<&P::supervisor, &S::emergency_stop_damps_s>(0.0, 1e6)},
    {"supervisor", "stand_pose_margin_rad", "rad",
     "Standing up waits until joints and torso are this near to the standing pose",
     real<&P::supervisor, &S::stand_pose_margin_rad>(0.01, 3.2)},
    {"supervisor", "stand_speed_rad_s", "rad/s", "And until they are slower than this",
     real<&P::supervisor, &S::stand_speed_rad_s>(0.01, 100.0)},
    {"supervisor", "stance_margin_rad", "rad",
     "Farther off the standing pose while it stands up, and the attempt ends, damped",
     real<&P::supervisor, &S::stance_margin_rad>(0.01, 6.3)},
    {"supervisor", "stand_ramp_s", "s", "Time over which the torque law takes over when standing up",
     real<&P::supervisor, &S::stand_ramp_s>(0.0, 60.0)},
    {"supervisor", "slow_down_s", "s", "Time of stepping in place between walking and standing",
     real<&P::supervisor, &S::slow_down_s>(0.0, 60.0)},
    {"supervisor", "reset_window_s", "s",
     "Time after a reset was asked for in which every cause must be gone",
     real<&P::supervisor, &S::reset_window_s>(0.01, 60.0)},
    {"supervisor", "hold_kp_Nm_rad", "Nm/rad", "Holding and sitting: kp of every joint",
     real<&P::supervisor, &S::hold_kp_Nm_rad>(0.0, 10000.0)},
    {"supervisor", "hold_kd_Nms_rad", "Nm s/rad", "Holding and sitting: kd of every joint",
     real<&P::supervisor, &S::hold_kd_Nms_rad>(0.0, 1000.0)},
    {"supervisor", "hold_ramp_s", "s", "Holding and sitting: time from nothing to these gains",
     real<&P::supervisor, &S::hold_ramp_s>(0.0, 10.0)},
    {"supervisor", "damping_kd_Nms_rad", "Nm s/rad", "Damping: kd of every joint",
     real<&P::supervisor, &S::damping_kd_Nms_rad>(0.0, 1000.0)},
    {"supervisor", "damping_torque_Nm", "Nm", "Damping: largest torque; less kd at high speed",
     real<&P::supervisor, &S::damping_torque_Nm>(0.0, 1000.0)},
    {"supervisor", "sit_s", "s", "Time from the measured pose to the sitting pose",
     real<&P::supervisor, &S::sit_s>(0.05, 60.0)},
    {"supervisor", "sit_hip_rad", "rad", "Sitting pose: both hips",
     real<&P::supervisor, &S::sit_hip_rad>(-3.2, 3.2)},
    {"supervisor", "sit_knee_rad", "rad", "Sitting pose: both knees",
     real<&P::supervisor, &S::sit_knee_rad>(-3.2, 3.2)},
};

}  // namespace

std::span<const Section> supervisor_sections() { return kSections; }

std::span<const Entry> supervisor_entries() { return kEntries; }

}  // namespace stilt::configuration
