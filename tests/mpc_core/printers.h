#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <ostream>

#include "mpc_core/control/plan.h"
#include "mpc_core/model/types.h"

/// How GoogleTest prints states and plans when a test fails.
namespace Eigen {

/// "[x_b 0 z_b 0.8 pitch_b 0 | hip_L ... | v: ...]", m, rad and their rates.
inline void PrintTo(const Matrix<double, stilt::model::kStates, 1>& state, std::ostream* out) {
  constexpr const char* kNames[] = {"x_b", "z_b", "pitch_b", "hip_L", "knee_L", "hip_R", "knee_R"};
  static_assert(std::size(kNames) == stilt::model::kPositions);
  *out << "[q:";
  for (int i = 0; i < stilt::model::kPositions; ++i) *out << ' ' << kNames[i] << ' ' << state[i];
  *out << " | v:";
  for (int i = 0; i < stilt::model::kPositions; ++i) {
    *out << ' ' << kNames[i] << ' ' << state[stilt::model::kPositions + i];
  }
  *out << ']';
}

}  // namespace Eigen

namespace stilt::model {

inline void PrintTo(ContactMode mode, std::ostream* out) {
  constexpr const char* kNames[] = {"flight", "left foot", "right foot", "both feet"};
  *out << kNames[(mode.left ? 1 : 0) + (mode.right ? 2 : 0)];
}

}  // namespace stilt::model

namespace stilt::control {

/// Number, start, end, and the first and last node.
inline void PrintTo(const Plan& plan, std::ostream* out) {
  *out << "plan " << plan.sequence << ": " << plan.nodes << " nodes";
  if (plan.nodes <= 0) return;
  for (const int k : {0, plan.nodes - 1}) {
    const PlanNode& node = plan.node[static_cast<std::size_t>(k)];
    *out << "\n  node " << k << " at " << node.time_s << " s, ";
    PrintTo(node.mode, out);
    *out << "\n    x = ";
    PrintTo(node.state, out);
    *out << "\n    u = [" << node.input.transpose() << ']';
  }
  *out << "\n  " << plan.report.iterations << " iterations, status " << static_cast<int>(plan.report.status)
       << ", defect " << plan.report.dynamics_defect_max << ", equality violation "
       << plan.report.equality_violation_max;
}

}  // namespace stilt::control
