#include "firmware/configuration/schema.h"

#include <vector>

#include "firmware/configuration/schema_fields.h"
#include "firmware/configuration/schema_tables.h"
#include "mpc_core/control/plan.h"

namespace stilt::configuration {
namespace {

using control::EstimatorParameters;
using control::GaitTrackerParameters;
using control::RobotParameters;
using control::TimingParameters;
using control::TorqueLawParameters;
using gait::GaitParameters;
using gait::ReferenceParameters;
using ocp::BarrierParameters;
using ocp::CostParameters;
using ocp::DiscretisationParameters;
using ocp::EqualityParameters;
using ocp::InequalityParameters;
using sqp::SqpParameters;
using P = Parameters;
using namespace fields;

// In the order of the enumerators.
constexpr std::string_view kIntegrators[] = {"rk2", "rk4"};
constexpr std::string_view kTransitions[] = {"identity", "impact"};
static_assert(static_cast<int>(ocp::Integrator::rk2) == 0 && static_cast<int>(ocp::Integrator::rk4) == 1);
static_assert(static_cast<int>(ocp::Transition::identity) == 0 &&
              static_cast<int>(ocp::Transition::impact) == 1);

static_assert(model::name_of(model::InstructionSet::avx512) == "avx512" &&
              model::name_of(model::InstructionSet::neon) == "neon");

static_assert(control::kMaxHorizonIntervals == 134, "the description of discretisation.horizon_s names it");

constexpr Section kSections[] = {
    {"robot",
     "What the controller assumes of the robot besides its URDF; friction and damping instead of the "
     "URDF's."},
    {"gait", "Timing and shape of the step."},
    {"reference", "Heuristic reference of the base: what the cost pulls towards."},
    {"cost",
     "Weights of the running cost 1/2 (e_x' Q e_x + e_u' R e_u + sum over feet of e_i' W e_i), e the\n"
     "difference to the reference. A larger one holds the quantity closer to it."},
    {"inequality",
     "Limits h >= 0, kept by relaxed logarithmic barriers: -weight ln h above the width, its quadratic\n"
     "continuation below. They are soft: a larger weight keeps further away, a larger width bends earlier."},
    {"equality",
     "Constraints on the feet. Where a solve converges, their residuals times the interval's duration are\n"
     "within sqp.violation_tolerance."},
    {"discretisation", "Time grid of the planning problem."},
    {"sqp",
     "Iterations of the solver. g is the root of the summed squares of the dynamics' defects, and of the\n"
     "equalities' residuals times the interval's duration."},
    {"torque_law",
     "torque = feed-forward + kp (q_plan - q) + kd (v_plan - v) + friction compensation, saturated."},
    {"gait_tracker",
     "A gait of the library tracked by the joints without planning: torque of the gait, kp and kd.\n"
     "See supervisor.track_gait and supervisor.select_gait."},
    {"estimator", "State of the base from joint encoders and base pitch."},
    {"timing", "Rates of the two loops."},
};

constexpr Entry kEntries[] = {
    {"robot", "armature_scale", "1", "Factor on the armature of the URDF; 0 plans without it",
     real<&P::robot, &RobotParameters::armature_scale>(0.0, 10.0)},
    {"robot", "torque_limit_scale", "1",
     "Factor on the joint torque limits of the URDF, of plans and the torque law only;\n"
     "supervisor.torque_limit_share limits all",
     real<&P::robot, &RobotParameters::torque_limit_scale>(0.05, 10.0)},
    {"robot", "velocity_limit_scale", "1", "Factor on the joint velocity limits of the URDF, in plans only",
     real<&P::robot, &RobotParameters::velocity_limit_scale>(0.05, 10.0)},

    {"robot", "no_load_speed_rad_s", "rad/s",
     "Joint speed at which a drive gives no torque any more; its torque falls linearly up to there; 0: "
     "constant",
     real<&P::robot, &RobotParameters::no_load_speed_rad_s>(0.0, 1e3)},
    {"robot", "hip_coulomb_friction_Nm", "Nm",
     "Coulomb friction of a hip, see torque_law.friction_compensation",
     real<&P::robot, &RobotParameters::hip_coulomb_friction_Nm>(0.0, 100.0)},
    {"robot", "knee_coulomb_friction_Nm", "Nm", "Coulomb friction of a knee",
     real<&P::robot, &RobotParameters::knee_coulomb_friction_Nm>(0.0, 100.0)},
    {"robot", "hip_damping_Nms_rad", "Nm s/rad", "Viscous friction of a hip, part of the planned torques",
     real<&P::robot, &RobotParameters::hip_damping_Nms_rad>(0.0, 100.0)},
    {"robot", "knee_damping_Nms_rad", "Nm s/rad", "Viscous friction of a knee",
     real<&P::robot, &RobotParameters::knee_damping_Nms_rad>(0.0, 100.0)},

    {"gait", "single_support_s", "s", "Duration of a step on one foot",
     real<&P::gait, &GaitParameters::single_support_s>(0.1, 2.0)},
    {"gait", "double_support_s", "s", "Time on both feet between two steps; 0 swaps the feet at once",
     real<&P::gait, &GaitParameters::double_support_s>(0.0, 1.0)},
    {"gait", "swing_height_m", "m", "Apex of the swing foot above the ground",
     real<&P::gait, &GaitParameters::swing_height_m>(0.005, 0.3)},
    {"gait", "touchdown_velocity_m_s", "m/s",
     "Vertical velocity of the swing reference at touch-down; a profile that ends flat lands early or late",
     real<&P::gait, &GaitParameters::touchdown_velocity_m_s>(-2.0, 0.0)},
    {"gait", "stand_half_width_m", "m",
     "Standing: distance of each foot from the hip, one ahead, one behind; point feet cannot stand together",
     real<&P::gait, &GaitParameters::stand_half_width_m>(0.02, 0.5)},
    {"gait", "switch_lead_s", "s", "Least time between the command to step and the first lift-off",
     real<&P::gait, &GaitParameters::switch_lead_s>(0.0, 5.0)},

    {"gait", "catch_falls", "", "Whether a standing robot that would fall steps until it stands again",
     flag<&P::gait, &GaitParameters::catch_falls>()},
    {"gait", "catch_margin_m", "m",
     "Distance of the capture point to leaving the feet at which these steps begin",
     real<&P::gait, &GaitParameters::catch_margin_m>(0.0, 0.2)},
    {"gait", "catch_lead_s", "s", "Time from then to the first lift-off",
     real<&P::gait, &GaitParameters::catch_lead_s>(0.0, 1.0)},
    {"gait", "catch_calm_m_s", "m/s", "These steps end after one during which the hip was slower",
     real<&P::gait, &GaitParameters::catch_calm_m_s>(0.01, 1.0)},
    {"reference", "base_height_m", "m", "Height of the hip above the ground",
     real<&P::reference, &ReferenceParameters::base_height_m>(0.1, 2.0)},
    {"reference", "base_pitch_rad", "rad", "Pitch of the torso, positive leans forward",
     real<&P::reference, &ReferenceParameters::base_pitch_rad>(-0.7, 0.7)},
    {"reference", "speed_ramp_m_s2", "m/s^2",
     "Rate of change of the speed reference; a stop takes at most 20 steps",
     real<&P::reference, &ReferenceParameters::speed_ramp_m_s2>(0.05, 20.0)},
    {"reference", "speed_follow_band_m_s", "m/s",
     "Largest difference of the speed reference from the measured speed",
     real<&P::reference, &ReferenceParameters::speed_follow_band_m_s>(0.05, 10.0)},
    {"reference", "speed_follow_max_m_s", "m/s",
     "Largest forward speed to which a faster robot raises the speed reference",
     real<&P::reference, &ReferenceParameters::speed_follow_max_m_s>(0.0, 10.0)},
    {"reference", "foothold_gain_s", "s",
     "Shift of the next foothold for each m/s of speed above the reference; heuristic reference only",
     real<&P::reference, &ReferenceParameters::foothold_gain_s>(0.0, 2.0)},
    {"reference", "foothold_gain_decay", "1", "Factor on that shift for each later foothold",
     real<&P::reference, &ReferenceParameters::foothold_gain_decay>(0.0, 1.0)},
    {"reference", "foothold_shift_max_m", "m", "Largest shift of a foothold",
     real<&P::reference, &ReferenceParameters::foothold_shift_max_m>(0.0, 1.0)},
    {"reference", "speed_trim_1_s", "1/s",
     "Trim of the speed reference: change per second for each m/s of steady error; 0 trims nothing",
     real<&P::reference, &ReferenceParameters::speed_trim_1_s>(0.0, 20.0)},
    {"reference", "speed_trim_steady_m_s", "m/s",
     "The error is steady while the mean speed changes by less from step to step",
     real<&P::reference, &ReferenceParameters::speed_trim_steady_m_s>(0.0, 10.0)},
    {"reference", "speed_trim_max_m_s", "m/s", "Largest trim of the speed reference",
     real<&P::reference, &ReferenceParameters::speed_trim_max_m_s>(0.0, 1.0)},

    {"cost", "base_x", "1/(m^2 s)", "Horizontal position of the hip",
     real<&P::cost, &CostParameters::base_x>(0.0, 1e6)},
    {"cost", "base_z", "1/(m^2 s)", "Height of the hip", real<&P::cost, &CostParameters::base_z>(0.0, 1e6)},
    {"cost", "base_pitch", "1/(rad^2 s)", "Pitch of the torso",
     real<&P::cost, &CostParameters::base_pitch>(0.0, 1e6)},
    {"cost", "joint_position", "1/(rad^2 s)", "Joint positions",
     real<&P::cost, &CostParameters::joint_position>(0.0, 1e6)},
    {"cost", "base_vx", "s/m^2", "Forward velocity of the hip",
     real<&P::cost, &CostParameters::base_vx>(0.0, 1e6)},
    {"cost", "base_vz", "s/m^2", "Vertical velocity of the hip",
     real<&P::cost, &CostParameters::base_vz>(0.0, 1e6)},
    {"cost", "base_pitch_rate", "s/rad^2", "Pitch rate of the torso",
     real<&P::cost, &CostParameters::base_pitch_rate>(0.0, 1e6)},
    {"cost", "joint_velocity", "s/rad^2", "Joint velocities",
     real<&P::cost, &CostParameters::joint_velocity>(0.0, 1e6)},
    {"cost", "joint_acceleration", "s^3/rad^2",
     "Joint accelerations; not zero, or the problem loses convexity",
     real<&P::cost, &CostParameters::joint_acceleration>(1e-8, 1e3)},
    {"cost", "contact_force", "1/(N^2 s)", "Contact forces; not zero, or the problem loses convexity",
     real<&P::cost, &CostParameters::contact_force>(1e-8, 1e3)},
    {"cost", "foot_position", "1/(m^2 s)", "Position of the feet",
     real<&P::cost, &CostParameters::foot_position>(0.0, 1e6)},
    {"cost", "foot_velocity", "s/m^2", "Velocity of the feet; too little and they drag",
     real<&P::cost, &CostParameters::foot_velocity>(0.0, 1e6)},
    {"cost", "foot_acceleration", "s^3/m^2", "Acceleration of the feet",
     real<&P::cost, &CostParameters::foot_acceleration>(0.0, 1e3)},
    {"cost", "touchdown_velocity", "s^2/m^2", "Horizontal velocity of a foot at the instant it touches down",
     real<&P::cost, &CostParameters::touchdown_velocity>(0.0, 1e6)},
    {"cost", "terminal", "1", "rho, factor on the LQR cost-to-go at the end of the horizon; 0 drops it",
     real<&P::cost, &CostParameters::terminal>(0.0, 1e3)},

    {"cost", "terminal_feet", "", "The running cost of that LQR has the weights of the feet, too",
     flag<&P::cost, &CostParameters::terminal_feet>()},

    {"inequality", "friction_coefficient", "1",
     "Friction cone: |fx| <= coefficient (fz - minimum normal force)",
     real<&P::inequality, &InequalityParameters::friction_coefficient>(0.05, 2.0)},
    {"inequality", "minimum_normal_force_share", "1",
     "Least planned normal force of a foot alone on the ground, as a share of the weight; a tenth with both "
     "feet",
     real<&P::inequality, &InequalityParameters::minimum_normal_force_share>(0.0, 0.45)},
    {"inequality", "friction_barrier_weight", "1/s", "Barrier of the friction cone: weight",
     real<&P::inequality, &InequalityParameters::friction, &BarrierParameters::weight>(0.0, 1e4)},
    {"inequality", "friction_barrier_width_N", "N", "Barrier of the friction cone: where it turns quadratic",
     real<&P::inequality, &InequalityParameters::friction, &BarrierParameters::width>(1e-3, 1e3)},
    {"inequality", "impulse_barrier_weight", "1",
     "Barrier of the friction cone on the impulse of a touch-down: weight, per touch-down",
     real<&P::inequality, &InequalityParameters::impulse, &BarrierParameters::weight>(0.0, 1e4)},
    {"inequality", "impulse_barrier_width_Ns", "Ns",
     "Barrier of the friction cone on the impulse: where it turns quadratic",
     real<&P::inequality, &InequalityParameters::impulse, &BarrierParameters::width>(1e-4, 100.0)},
    {"inequality", "joint_torque_barrier_weight", "1/s", "Barrier of the joint torques: weight",
     real<&P::inequality, &InequalityParameters::joint_torque, &BarrierParameters::weight>(0.0, 1e4)},
    {"inequality", "joint_torque_barrier_width_Nm", "Nm",
     "Barrier of the joint torques: where it turns quadratic",
     real<&P::inequality, &InequalityParameters::joint_torque, &BarrierParameters::width>(1e-3, 1e3)},
    {"inequality", "joint_position_barrier_weight", "1/s", "Barrier of the joint positions: weight",
     real<&P::inequality, &InequalityParameters::joint_position, &BarrierParameters::weight>(0.0, 1e4)},
    {"inequality", "joint_position_barrier_width_rad", "rad",
     "Barrier of the joint positions: where it turns quadratic",
     real<&P::inequality, &InequalityParameters::joint_position, &BarrierParameters::width>(1e-4, 10.0)},
    {"inequality", "joint_velocity_barrier_weight", "1/s", "Barrier of the joint velocities: weight",
     real<&P::inequality, &InequalityParameters::joint_velocity, &BarrierParameters::weight>(0.0, 1e4)},
    {"inequality", "joint_velocity_barrier_width_rad_s", "rad/s",
     "Barrier of the joint velocities: where it turns quadratic",
     real<&P::inequality, &InequalityParameters::joint_velocity, &BarrierParameters::width>(1e-4, 100.0)},

    {"equality", "stance_kd_1_s", "1/s", "kd of a foot on the ground: a + kd v = 0",
     real<&P::equality, &EqualityParameters::stance_kd_1_s>(0.0, 1e3)},
    {"equality", "swing_kp_1_s2", "1/s^2",
     "kp of a swinging foot, vertical: a - a_ref + kd (v - v_ref) + kp (p - p_ref) = 0",
     real<&P::equality, &EqualityParameters::swing_kp_1_s2>(0.0, 1e5)},
    {"equality", "swing_kd_1_s", "1/s", "kd of a swinging foot",
     real<&P::equality, &EqualityParameters::swing_kd_1_s>(0.0, 1e3)},
    {"equality", "rank_tolerance", "1",
     "A constraint of a swing foot, or of the second stance foot, is damped when the norm of its reduced\n"
     "row is below",
     real<&P::equality, &EqualityParameters::rank_tolerance>(1e-9, 1.0)},

    {"discretisation", "time_step_s", "s", "Distance of two nodes",
     real<&P::discretisation, &DiscretisationParameters::time_step_s>(0.002, 0.1)},
    {"discretisation", "horizon_s", "s", "How far the plan looks ahead; at most 134 time steps",
     real<&P::discretisation, &DiscretisationParameters::horizon_s>(0.05, 10.0)},
    {"discretisation", "switch_tolerance_s", "s",
     "A horizon that starts at most this long after a switch still contains its touch-down",
     real<&P::discretisation, &DiscretisationParameters::switch_tolerance_s>(0.0, 1e-3)},
    {"discretisation", "merge_below_s", "s", "Intervals shorter than this are merged with their neighbour",
     real<&P::discretisation, &DiscretisationParameters::merge_below_s>(0.0, 0.02)},
    {"discretisation", "integrator", "", "Runge-Kutta method of second (Heun) or fourth order",
     choice<&P::discretisation, &DiscretisationParameters::integrator>(kIntegrators)},
    {"discretisation", "transition", "", "Velocity at touch-down: unchanged, or through the impact map",
     choice<&P::discretisation, &DiscretisationParameters::transition>(kTransitions)},

    {"sqp", "iterations", "1", "Most iterations of one solve",
     integer<&P::sqp, &SqpParameters::iterations>(1, 100)},
    {"sqp", "backtracking_steps", "1",
     "Most shortened steps that the line searches of one solve try; bounds the work of a plan",
     integer<&P::sqp, &SqpParameters::backtracking_steps>(0, 1000)},
    {"sqp", "early_stop", "", "End when the tolerances are met, or when a line search accepts no step",
     flag<&P::sqp, &SqpParameters::early_stop>()},
    {"sqp", "cost_tolerance", "1", "Ends when the cost changes by less and g is below violation_tolerance",
     real<&P::sqp, &SqpParameters::cost_tolerance>(0.0, 10.0)},
    {"sqp", "violation_tolerance", "1", "See cost_tolerance",
     real<&P::sqp, &SqpParameters::violation_tolerance>(0.0, 10.0)},
    {"sqp", "step_tolerance", "1", "Ends when the largest component of the step is below",
     real<&P::sqp, &SqpParameters::step_tolerance>(0.0, 1.0)},
    {"sqp", "step_decrease", "1", "Line search: factor from one trial step to the next",
     real<&P::sqp, &SqpParameters::step_decrease>(0.05, 0.95)},
    {"sqp", "step_min", "1", "Line search: shortest trial step",
     real<&P::sqp, &SqpParameters::step_min>(1e-10, 1.0)},
    {"sqp", "filter_violation_max", "1", "Line search: above this g only less g is accepted",
     real<&P::sqp, &SqpParameters::filter_violation_max>(1e-6, 1e12)},
    {"sqp", "filter_violation_min", "1",
     "Line search: below this g the cost alone decides, where it is predicted to fall; elsewhere less g is\n"
     "accepted, too",
     real<&P::sqp, &SqpParameters::filter_violation_min>(0.0, 1e3)},
    {"sqp", "filter_margin", "1",
     "Line search: least decrease of g relative to g, or of the cost for each unit of g",
     real<&P::sqp, &SqpParameters::filter_margin>(0.0, 0.1)},
    {"sqp", "armijo", "1", "Line search: share of the predicted decrease of the cost that is asked for",
     real<&P::sqp, &SqpParameters::armijo>(0.0, 0.5)},
    {"sqp", "plan_defect_max", "1", "A plan with a larger defect is not used; 1e6: every plan is",
     real<&P::sqp, &SqpParameters::plan_defect_max>(1e-6, 1e12)},
    {"sqp", "plan_cone_violation_max_N", "N",
     "A plan that violates the friction cone by more is not used; 1e6: every plan is",
     real<&P::sqp, &SqpParameters::plan_cone_violation_max_N>(0.0, 1e12)},
    {"sqp", "plan_pulling_force_max_N", "N",
     "A plan with a stance foot that pulls at the ground by more is not used; 1e6: every plan is",
     real<&P::sqp, &SqpParameters::plan_pulling_force_max_N>(0.0, 1e12)},
    {"sqp", "instruction_set", "",
     "Instructions that the planner uses; auto: the best of the processor, in simulations those of the build",
     choice<&P::sqp, &SqpParameters::instruction_set>(model::kInstructionSetNames)},

    {"torque_law", "joint_kp_Nm_rad", "Nm/rad", "kp of every joint",
     real<&P::torque_law, &TorqueLawParameters::joint_kp_Nm_rad>(0.0, 1e4)},
    {"torque_law", "joint_kd_Nms_rad", "Nm s/rad", "kd of every joint",
     real<&P::torque_law, &TorqueLawParameters::joint_kd_Nms_rad>(0.0, 1e3)},
    {"torque_law", "use_feedback_gains", "", "Add the feedback K (x - x_plan) of an aged plan to its inputs",
     flag<&P::torque_law, &TorqueLawParameters::use_feedback_gains>()},
    {"torque_law", "feedback_from_age_s", "s", "Age of a plan from which a share of its feedback acts",
     real<&P::torque_law, &TorqueLawParameters::feedback_from_age_s>(0.0, 1.0)},
    {"torque_law", "feedback_full_age_s", "s",
     "Age of a plan from which all of its feedback acts; the share grows linearly",
     real<&P::torque_law, &TorqueLawParameters::feedback_full_age_s>(0.0, 1.0)},
    {"torque_law", "minimum_normal_force_share", "1",
     "Least normal force of a foot alone on the ground, as a share of the weight; a tenth with both feet",
     real<&P::torque_law, &TorqueLawParameters::minimum_normal_force_share>(0.0, 0.45)},
    {"torque_law", "friction_compensation", "1", "Share of the joints' Coulomb friction that is fed forward",
     real<&P::torque_law, &TorqueLawParameters::friction_compensation>(0.0, 2.0)},
    {"torque_law", "friction_velocity_rad_s", "rad/s", "Width of the smoothed sign, tanh(v / width)",
     real<&P::torque_law, &TorqueLawParameters::friction_velocity_rad_s>(1e-3, 10.0)},

    {"gait_tracker", "joint_kp_Nm_rad", "Nm/rad", "kp of every joint",
     real<&P::gait_tracker, &GaitTrackerParameters::joint_kp_Nm_rad>(0.0, 1e4)},
    {"gait_tracker", "joint_kd_Nms_rad", "Nm s/rad", "kd of every joint",
     real<&P::gait_tracker, &GaitTrackerParameters::joint_kd_Nms_rad>(0.0, 1e3)},
    {"gait_tracker", "settle_s", "s", "Foot placement uses the state this long after touch-down",
     real<&P::gait_tracker, &GaitTrackerParameters::settle_s>(0.0, 0.5)},
    {"gait_tracker", "take_over_s", "s",
     "Time over which the joints leave the motion before the gait for the gait's",
     real<&P::gait_tracker, &GaitTrackerParameters::take_over_s>(0.0, 2.0)},

    {"estimator", "blend_s", "s", "Time over which the weight moves from the old stance foot to the new one",
     real<&P::estimator, &EstimatorParameters::blend_s>(0.0, 0.5)},
    {"estimator", "velocity_filter_s", "s",
     "Time constant with which the base's velocity follows the measured one around the plan's; 0: no filter",
     real<&P::estimator, &EstimatorParameters::velocity_filter_s>(0.0, 0.1)},
    {"estimator", "velocity_correction_max_m_s2", "m/s^2",
     "Largest rate at which the base's linear velocity follows the measured one",
     real<&P::estimator, &EstimatorParameters::velocity_correction_max_m_s2>(0.1, 1e6)},

    {"timing", "torque_rate_hz", "Hz", "Rate of the torque loop",
     real<&P::timing, &TimingParameters::torque_rate_hz>(100.0, 10000.0)},
    {"timing", "plan_rate_hz", "Hz", "Rate of the planner",
     real<&P::timing, &TimingParameters::plan_rate_hz>(1.0, 2000.0)},
    {"timing", "plan_delay_s", "s",
     "Simulated time between the state a plan starts from and its first use. With one that is longer than\n"
     "1 / plan_rate_hz plans are made that much less often",
     real<&P::timing, &TimingParameters::plan_delay_s>(0.0, 0.2)},
};

}  // namespace

std::span<const Section> sections() {
  static const std::vector<Section> all = [] {
    std::vector<Section> joined(std::begin(kSections), std::end(kSections));
    for (const auto more :
         {hardware_sections(), supervisor_sections(), runtime_sections(), telemetry_sections()}) {
      joined.insert(joined.end(), more.begin(), more.end());
    }
    return joined;
  }();
  return all;
}

std::span<const Entry> entries() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> joined(std::begin(kEntries), std::end(kEntries));
    for (const auto more :
         {hardware_entries(), supervisor_entries(), runtime_entries(), telemetry_entries()}) {
      joined.insert(joined.end(), more.begin(), more.end());
    }
    return joined;
  }();
  return all;
}

}  // namespace stilt::configuration
