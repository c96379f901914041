#pragma once

#include <array>

#include "mpc_core/gait/command.h"
#include "mpc_core/model/types.h"
#include "mpc_core/ocp/horizon.h"
#include "mpc_core/sqp/solve_report.h"

namespace stilt::control {

using ocp::kMaxHorizonIntervals;
using ocp::kMaxNodes;
using ocp::kMaxSwitches;

using FeedbackGain = Eigen::Matrix<double, model::kInputs, model::kStates>;

/// One node of the plan. At a contact switch two nodes share a time: before and after the transition.
struct PlanNode {
  double time_s = 0.0;
  model::StateVector state = model::StateVector::Zero();
  model::InputVector input = model::InputVector::Zero();  ///< the model holds it until the next node
  FeedbackGain gain = FeedbackGain::Zero();               ///< input += gain (x - state)
  model::ContactMode mode;                                ///< of the interval that starts at this node
};

/// State and input trajectory over the horizon, and the report of the solve that computed it. Times are those
/// of the controller's clock, s.
struct Plan {
  long long sequence = -1;  ///< number of usable plans before it; -1: no plan yet
  int nodes = 0;
  double start_time_s = 0.0;
  gait::GaitKind gait = gait::GaitKind::stand;  ///< active gait at start_time_s
  double phase_end_s = 0.0;                     ///< end of the contact phase that is active at start_time_s
  std::array<PlanNode, kMaxNodes> node;
  sqp::SolveReport report;
};

/// The plan at one time. Positions follow the cubic through the nodes' positions and velocities; velocities
/// are linear. Inputs are linear within a contact phase and held at its end. Inputs held over every interval
/// lag behind the motion, so that touch-down comes early and torques peak.
struct PlanPoint {
  model::StateVector state = model::StateVector::Zero();
  model::InputVector input = model::InputVector::Zero();
  const FeedbackGain* gain = nullptr;  ///< of the plan's node; points into the plan
  model::ContactMode mode;
  double age_s = 0.0;  ///< since the state that the plan started from
};

/// Plan at a time, clamped to its ends. The plan has at least two nodes. Real-time safe.
[[nodiscard]] PlanPoint interpolate(const Plan& plan, double time_s) noexcept;

}  // namespace stilt::control
