#include "mpc_core/control/planner.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/model/debug_assert.h"

namespace stilt::control {
namespace {

using model::kInputs;
using model::kPositions;
using model::kStates;

model::FeetVector foot_positions(const model::RobotModel& robot, const model::StateVector& state) noexcept {
  model::KinematicsTerms<double> feet;
  robot.kinematics(state.data(), feet);
  return model::FeetVector(feet.foot_position);
}

// docs/decisions/0022-feasible-plans.md, 0037-feasible-plans.md
bool feasible(const sqp::SqpParameters& p, const sqp::SolveReport& report) noexcept {
  const ocp::Violations& v = report.violations;
  return report.dynamics_defect_max <= p.plan_defect_max &&
         v.friction_cone_violation_max_N <= p.plan_cone_violation_max_N &&
         v.pulling_force_max_N <= p.plan_pulling_force_max_N;
}

}  // namespace

ConfigureStatus Planner::configure(const model::RobotModel& robot,
                                   const ControllerParameters& parameters) noexcept {
  PlannerSettings settings;
  const ConfigureStatus status = prepare_settings(robot, parameters, terminal_cost_work_, settings);
  if (status != ConfigureStatus::horizon_over_capacity) adopt(settings);
  return status;
}

void Planner::adopt(const PlannerSettings& settings) noexcept {
  parameters_ = settings.parameters;
  data_ = settings.data;
}

void Planner::reset(double time_s) noexcept {
  schedule_.reset(time_s);
  catcher_.reset();
  speed_reference_m_s_ = 0.0;
  trim_.reset();
  has_solution_ = false;
}

bool Planner::prepare(const PlannerInput& input) noexcept {
  const model::FeetVector feet = foot_positions(*data_.robot, input.state);
  if (has_solution_) speed_reference_m_s_ = reference_.speed_at(input.time_s);
  // A swing that starts within the horizon needs its next contact and the middle of that contact.
  const double beyond_s = 4.0 * (parameters_.gait.single_support_s + parameters_.gait.double_support_s);
  const auto phase_now = [&]() -> const gait::ContactPhase& {
    return schedule_.phase(schedule_.index_at(input.time_s));
  };
  const auto stands = [&] { return phase_now().gait == gait::GaitKind::stand; };
  const double standing_s = stands() ? input.time_s - phase_now().start_s : 0.0;
  const gait::GaitCommand command = catcher_.update(
      input.time_s, input.command, standing_s, input.state[kPositions],
      capture_point_x_m(*data_.robot, data_.joint_parameters, input.state), feet, parameters_.gait);
  schedule_.update(input.time_s, input.time_s + parameters_.discretisation.horizon_s + beyond_s, command,
                   parameters_.gait, parameters_.reference, speed_reference_m_s_, feet[0] >= feet[2],
                   catcher_.fall(), input.tracked);
  const double trim_m_s =
      trim_.update({.time_s = input.time_s,
                    .base_x_m = input.state[0],
                    .speed_reference_m_s = speed_reference_m_s_,
                    .contact = phase_now().mode,
                    .stepping = has_solution_ && !stands() && catcher_.fall() == gait::Fall::none},
                   parameters_.reference);
  reference_.prepare(data_.robot->constants, schedule_, command, parameters_.gait, parameters_.reference,
                     input.time_s, input.state, feet, speed_reference_m_s_, trim_m_s);
  if (!ocp::build_horizon(schedule_, input.time_s, parameters_.discretisation, problem_.horizon))
    return false;
  ocp::fill_batches(reference_, problem_);
  for (int i = 0; i < kStates; ++i) problem_.x_initial[i] = input.state[i];
  bring_stance_foot_to_rest();
  return true;
}

void Planner::bring_stance_foot_to_rest() noexcept {
  const ocp::Stage& first = problem_.horizon.stage[0];
  if (first.kind == ocp::StageKind::transition || first.mode.count() != 1) return;
  model::ImpactTerms<double> contact;
  data_.robot->impact(first.mode, problem_.x_initial, data_.joint_parameters, contact);
  std::copy(contact.velocity_after, contact.velocity_after + kPositions, problem_.x_initial + kPositions);
}

void Planner::guess_node(double time_s, int phase, bool before_switch, double* x, double* u,
                         int& hint) const noexcept {
  const auto take_reference_input = [&] {
    const gait::ReferencePoint point = reference_.evaluate(time_s, phase);
    std::copy(point.input.data(), point.input.data() + kInputs, u);
    return point.state;
  };
  if (!has_solution_) {
    for (int i = 0; i < kStates; ++i) x[i] = problem_.x_initial[i];
    x[0] = take_reference_input()[0];
    return;
  }
  const ocp::Trajectory& old = solution_[current_];
  const ocp::Horizon& horizon = solved_horizon_;
  // Last old node not after this time. At a switch: the node on the requested side.
  while (hint < horizon.stages && (horizon.node_time_s(hint + 1) < time_s ||
                                   (!before_switch && horizon.node_time_s(hint + 1) == time_s))) {
    ++hint;
  }
  // A first node just before a switch takes the switch: the node behind it begins behind the old one.
  const model::ContactMode mode = schedule_.phase(phase).mode;
  while (!before_switch && hint + 1 < horizon.stages &&
         (horizon.stage[hint].mode != mode || horizon.stage[hint].kind == ocp::StageKind::transition) &&
         horizon.node_time_s(hint + 1) <= time_s + parameters_.discretisation.merge_below_s) {
    ++hint;
  }
  if (hint >= horizon.stages) {  // beyond the old horizon: its last posture moves with the reference
    std::copy(old.x[horizon.stages], old.x[horizon.stages] + kStates, x);
    x[0] += (time_s - horizon.end_s) * take_reference_input()[kPositions];
    return;
  }
  const double start_s = horizon.node_time_s(hint);
  const double duration_s = horizon.node_time_s(hint + 1) - start_s;
  const double s = duration_s > 0.0 ? std::clamp((time_s - start_s) / duration_s, 0.0, 1.0) : 0.0;
  for (int i = 0; i < kStates; ++i) x[i] = (1.0 - s) * old.x[hint][i] + s * old.x[hint + 1][i];
  const ocp::Stage& stage = horizon.stage[hint];
  if (stage.kind == ocp::StageKind::flow && stage.mode == mode) {
    std::copy(old.u[hint], old.u[hint] + kInputs, u);
  } else {
    take_reference_input();
  }
}

void Planner::warm_start(ocp::Trajectory& guess) const noexcept {
  const ocp::Horizon& horizon = problem_.horizon;
  int hint = 0;
  for (int k = 0; k < horizon.stages; ++k) {
    const ocp::Stage& stage = horizon.stage[k];
    const bool transition = stage.kind == ocp::StageKind::transition;
    guess_node(stage.time_s, stage.phase, transition, guess.x[k], guess.u[k], hint);
    if (transition) std::fill(guess.u[k], guess.u[k] + kInputs, 0.0);
  }
  double unused[kInputs];
  guess_node(horizon.end_s, horizon.end_phase, false, guess.x[horizon.stages], unused, hint);
  std::copy(problem_.x_initial, problem_.x_initial + kStates, guess.x[0]);
  for (int k = 0; k <= horizon.stages; ++k) std::fill(guess.x[k] + kStates, guess.x[k] + lq::kRows, 0.0);
}

sqp::SolveReport Planner::plan(const PlannerInput& input, Plan& plan) noexcept {
  sqp::SolveReport report;
  const bool finite =
      std::isfinite(input.time_s) && input.state.allFinite() && std::isfinite(input.command.speed_m_s);
  STILT_ASSERT(data_.robot != nullptr);
  STILT_ASSERT(!finite || !has_solution_ || input.time_s >= solved_horizon_.node_time_s(0));
  if (!finite || !prepare(input)) return report;
  ocp::Trajectory& work = solution_[1 - current_];
  warm_start(work);
  report = sqp_.solve(data_, problem_, parameters_.sqp, work);
  if (report.usable() && !feasible(parameters_.sqp, report)) report.status = sqp::SolveStatus::infeasible;
  // After an infeasible plan the next solve starts cold; a cold start that is infeasible is continued.
  const bool is_cold_start = !has_solution_;
  has_solution_ = report.usable() || (is_cold_start && report.status == sqp::SolveStatus::infeasible);
  if (has_solution_) {
    current_ = 1 - current_;
    solved_horizon_ = problem_.horizon;
  }
  if (report.usable()) write_plan(input, report, plan);
  return report;
}

void Planner::write_plan(const PlannerInput& input, const sqp::SolveReport& report, Plan& plan) noexcept {
  const ocp::Horizon& horizon = problem_.horizon;
  const ocp::Trajectory& solution = solution_[current_];
  const int phase = schedule_.index_at(input.time_s);
  plan.sequence = sequence_++;
  plan.nodes = horizon.stages + 1;
  plan.start_time_s = input.time_s;
  plan.gait = schedule_.phase(phase).gait;
  plan.phase_end_s = schedule_.end_s(phase);
  plan.report = report;
  for (int k = 0; k <= horizon.stages; ++k) {
    const int stage = std::min(k, horizon.stages - 1);
    PlanNode& node = plan.node[k];
    node.time_s = horizon.node_time_s(k);
    node.state = Eigen::Map<const model::StateVector>(solution.x[k]);
    node.input = Eigen::Map<const model::InputVector>(solution.u[stage]);
    node.mode = horizon.stage[stage].mode;
    sqp_.feedback_gain(stage, node.gain);
    STILT_ASSERT(node.state.allFinite() && node.input.allFinite() && node.gain.allFinite());
  }
}

}  // namespace stilt::control
