#include "tests/mpc_core/control/recorded_problems.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mpc_core/sqp/terminal_cost.h"
#include "tests/robots.h"

namespace stilt::testing_support {
namespace {

using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

constexpr int kSampledNodes = 5;

constexpr ocp::CostParameters kCost{.base_x = 5.0,
                                    .base_z = 400.0,
                                    .base_pitch = 200.0,
                                    .joint_position = 5.0,
                                    .base_vx = 40.0,
                                    .base_vz = 20.0,
                                    .base_pitch_rate = 10.0,
                                    .joint_velocity = 0.5,
                                    .joint_acceleration = 2e-3,
                                    .contact_force = 1e-3,
                                    .foot_position = 100.0,
                                    .foot_velocity = 20.0,
                                    .foot_acceleration = 1e-4,
                                    .touchdown_velocity = 1.0,
                                    .terminal = 1.0};

constexpr double kMinimumNormalForce_N = 5.0;
constexpr ocp::InequalityParameters kInequality{.friction_coefficient = 0.6,
                                                .friction = {0.2, 5.0},
                                                .impulse = {0.0, 0.5},
                                                .joint_torque = {0.2, 3.0},
                                                .joint_position = {0.05, 0.05},
                                                .joint_velocity = {0.05, 0.5}};

constexpr ocp::EqualityParameters kEquality{
    .stance_kd_1_s = 20.0, .swing_kp_1_s2 = 200.0, .swing_kd_1_s = 20.0, .rank_tolerance = 1e-3};

gait::GaitParameters gait_of(const PlanningQuestion& question) {
  return {.single_support_s = question.robot == "rabbit" ? 0.4 : 0.3,
          .double_support_s = question.double_support_s,
          .swing_height_m = 0.06,
          .touchdown_velocity_m_s = -0.2,
          .stand_half_width_m = 0.15,
          .switch_lead_s = 0.3};
}

gait::ReferenceParameters reference_of(const PlanningQuestion& question) {
  return {.base_height_m = question.robot == "rabbit" ? 0.735 : 0.8,
          .base_pitch_rad = 0.0,
          .speed_ramp_m_s2 = 1.0,
          .speed_follow_band_m_s = 1e9,
          .foothold_gain_s = 0.0,
          .speed_trim_1_s = 0.5,
          .speed_trim_max_m_s = 0.15};
}

ocp::ProblemData data_of(const PlanningQuestion& question, const model::RobotModel& robot) {
  ocp::ProblemData data;
  data.robot = &robot;
  data.cost = kCost;
  data.inequality = kInequality;
  data.equality = kEquality;
  data.discretisation = {.time_step_s = 0.015,
                         .horizon_s = question.horizon_s,
                         .switch_tolerance_s = 0.0,
                         .merge_below_s = 0.002,
                         .integrator = question.integrator,
                         .transition = question.transition};
  for (int j = 0; j < kJoints; ++j) {
    data.limits.position_min_rad[j] = robot.constants.position_min_rad[j];
    data.limits.position_max_rad[j] = robot.constants.position_max_rad[j];
    data.limits.velocity_rad_s[j] = robot.constants.velocity_limit_rad_s[j];
    data.limits.torque_Nm[j] = robot.constants.torque_limit_Nm[j];
  }
  std::ranges::copy(robot.constants.joint_parameters, data.joint_parameters);
  ocp::set_weights(data);
  data.minimum_normal_force_N = {{0.0, kMinimumNormalForce_N, kMinimumNormalForce_N}};
  const gait::ReferenceParameters reference = reference_of(question);
  const model::StateVector standing =
      gait::standing_state(robot.constants, reference.base_height_m, reference.base_pitch_rad,
                           gait_of(question).stand_half_width_m, true);
  const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
  if (!sqp::set_terminal_cost(data, standing, *work)) {
    throw std::invalid_argument("recorded problem: the weights admit no terminal cost");
  }
  return data;
}

gait::ContactSchedule schedule_of(const PlanningQuestion& question) {
  const gait::GaitParameters gait = gait_of(question);
  const gait::ReferenceParameters reference = reference_of(question);
  const double beyond_s = question.horizon_s + 4.0 * (gait.single_support_s + gait.double_support_s);
  gait::ContactSchedule schedule;
  schedule.reset(0.0);
  const auto update = [&](double time_s, const gait::GaitCommand& command) {
    schedule.update(time_s, time_s + beyond_s, command, gait, reference, question.speed_reference_m_s, true);
  };
  update(0.0, question.command);
  const bool stops = question.stop_time_s >= 0.0 && question.stop_time_s <= question.time_s;
  // In steps, because the schedule keeps only a little of the past and holds a limited future.
  for (double time_s = 0.1; time_s < question.time_s; time_s += 0.1) {
    const bool stopped = stops && time_s >= question.stop_time_s;
    update(time_s, stopped ? gait::GaitCommand{} : question.command);
  }
  update(question.time_s, stops ? gait::GaitCommand{} : question.command);
  return schedule;
}

void fill_guess(const gait::HeuristicReference& reference, PreparedProblem& prepared) {
  const ocp::Horizon& horizon = prepared.problem.horizon;
  prepared.guess = ocp::Trajectory{};
  for (int k = 0; k <= horizon.stages; ++k) {
    const bool end = k == horizon.stages;
    const ocp::Stage& stage = horizon.stage[static_cast<std::size_t>(std::min(k, horizon.stages - 1))];
    const gait::ReferencePoint point =
        reference.evaluate(end ? horizon.end_s : stage.time_s, end ? horizon.end_phase : stage.phase);
    std::copy(prepared.problem.x_initial, prepared.problem.x_initial + kStates, prepared.guess.x[k]);
    if (k > 0) prepared.guess.x[k][0] = point.state[0];
    if (end || stage.kind != ocp::StageKind::flow) continue;
    std::copy(point.input.begin(), point.input.end(), prepared.guess.u[k]);
  }
}

sqp::SqpParameters with_line_search() {
  return {.iterations = kSearchIterations,
          .early_stop = true,
          .cost_tolerance = 0.0,
          .violation_tolerance = 0.0,
          .step_tolerance = kSearchStep,
          .step_decrease = 0.5,
          .step_min = 1e-4,
          .filter_violation_max = 1e6,
          .filter_violation_min = 1e-6,
          .filter_margin = 1e-6,
          .armijo = 1e-4};
}

/// Any finite step passes: a negative filter_margin lets the violation grow.
sqp::SqpParameters full_step() {
  sqp::SqpParameters parameters = with_line_search();
  parameters.iterations = 1;
  parameters.early_stop = false;
  parameters.filter_violation_min = 0.0;
  parameters.filter_margin = -1e100;
  return parameters;
}

/// Kinds of quantities that share a scale: [first, last) in [x; u].
constexpr int kKinds[][2] = {{0, kPositions},
                             {kPositions, kStates},
                             {kStates, kStates + kJoints},
                             {kStates + kJoints, kStates + kInputs}};

double entry(const OptimalNode& node, int i) { return i < kStates ? node.state[i] : node.input[i - kStates]; }

}  // namespace

std::unique_ptr<PreparedProblem> prepare(const PlanningQuestion& question) {
  const model::RobotModel* robot = testing_support::find_robot(question.robot);
  if (robot == nullptr) throw std::invalid_argument("recorded problem: no robot " + question.robot);
  auto prepared = std::make_unique<PreparedProblem>();
  prepared->data = data_of(question, *robot);
  const gait::ContactSchedule schedule = schedule_of(question);
  model::KinematicsTerms<double> feet;
  robot->kinematics(question.state.data(), feet);
  const bool stops = question.stop_time_s >= 0.0 && question.stop_time_s <= question.time_s;
  gait::HeuristicReference reference;
  reference.prepare(robot->constants, schedule, stops ? gait::GaitCommand{} : question.command,
                    gait_of(question), reference_of(question), question.time_s, question.state,
                    model::FeetVector(feet.foot_position), question.speed_reference_m_s,
                    question.speed_trim_m_s);
  ocp::Problem& problem = prepared->problem;
  if (!ocp::build_horizon(schedule, question.time_s, prepared->data.discretisation, problem.horizon)) {
    throw std::invalid_argument("recorded problem: the horizon does not fit");
  }
  ocp::fill_batches(reference, problem);
  std::ranges::copy(question.state, problem.x_initial);
  fill_guess(reference, *prepared);
  return prepared;
}

HardSolve solve_hard(const PreparedProblem& prepared, sqp::Sqp& sqp, ocp::Trajectory& iterate) {
  const auto solve = [&](const sqp::SqpParameters& parameters) {
    return sqp.solve(prepared.data, prepared.problem, parameters, iterate);
  };
  sqp::SolveReport report = solve(with_line_search());
  int iterations = report.iterations;
  double last_step = report.step_component_max;
  for (int i = 0; report.usable() && i < kPolishIterations; ++i, ++iterations) {
    report = solve(full_step());
    last_step = report.step_component_max;
    if (last_step < kPolishStep) break;
  }
  return {.usable = report.usable(),
          .cost = report.cost,
          .last_step = last_step,
          .violation = std::max(report.dynamics_defect_max, report.equality_violation_max),
          .iterations = iterations};
}

RecordedOptimum sampled(const PreparedProblem& prepared, const ocp::Trajectory& solution, double cost) {
  RecordedOptimum optimum{.cost = cost, .stages = prepared.problem.horizon.stages, .nodes = {}};
  for (int i = 0; i < kSampledNodes; ++i) {
    const int k = i * optimum.stages / (kSampledNodes - 1);
    const double* u = solution.u[std::min(k, optimum.stages - 1)];
    optimum.nodes.push_back({.node = k,
                             .state = Eigen::Map<const model::StateVector>(solution.x[k]),
                             .input = Eigen::Map<const model::InputVector>(u)});
  }
  return optimum;
}

double distance(const RecordedOptimum& a, const RecordedOptimum& b) {
  if (a.stages != b.stages || a.nodes.size() != b.nodes.size()) return INFINITY;
  double largest = 0.0;
  for (const auto& [first, last] : kKinds) {
    double scale = 1.0;
    double difference = 0.0;
    for (std::size_t n = 0; n < a.nodes.size(); ++n) {
      for (int i = first; i < last; ++i) {
        scale = std::max(scale, std::abs(entry(b.nodes[n], i)));
        const double change = std::abs(entry(a.nodes[n], i) - entry(b.nodes[n], i));
        difference = change <= difference ? difference : change;  // a NaN stays
      }
    }
    largest = difference / scale <= largest ? largest : difference / scale;
  }
  return largest;
}

}  // namespace stilt::testing_support
