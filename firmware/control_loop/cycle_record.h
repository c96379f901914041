#pragma once

#include <array>
#include <cstdint>

#include "firmware/control_loop/messages.h"
#include "mpc_core/control/plan.h"

namespace stilt::control_loop {

/// What one solve of the planner was given and came to, so that a replay can run it again.
struct CycleRecord {
  std::uint64_t cycle = 0;           ///< counts solves from 1
  std::int64_t tick = -1;            ///< of the torque loop, whose request was answered
  double time_s = 0.0;               ///< of the state in it, controller's clock
  std::uint32_t stance_episode = 0;  ///< PlanningRequest::stance_episode
  long long plan_sequence = -1;      ///< -1: no usable plan
  std::uint32_t failures = 0;        ///< in a row, this one included
  std::uint32_t tuning = 0;          ///< number of the active tuning
  int nodes = 0;
  std::uint64_t checksum = 0;  ///< see plan_checksum(); 0 without a plan
  std::int64_t solve_ns = 0;   ///< 0 in lock-step
  sqp::SolveReport report;
};

/// Some nodes of a plan, for drawing.
struct PlanPreview {
  static constexpr int kMaxNodes = 48;
  struct Node {
    double time_s = 0.0;
    model::StateVector state = model::StateVector::Zero();
    model::InputVector input = model::InputVector::Zero();
    model::ContactMode mode;
  };
  long long sequence = -1;
  double start_time_s = 0.0;
  int count = 0;
  std::array<Node, kMaxNodes> node;
};

/// The plan at its first node, then at nodes at least `spacing_s` apart (more, when they would be too many),
/// and at the last. Real-time.
void preview_plan(const control::Plan& plan, double spacing_s, PlanPreview& preview) noexcept;

}  // namespace stilt::control_loop
