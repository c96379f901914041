#include "host_tools/experiments/walks.h"

#include <cmath>

namespace stilt::experiments {
namespace {

constexpr double kShare = 0.1;
constexpr double kAtZero_m_s = 0.03;
constexpr double kRounding_m_s = 1e-9;

}  // namespace

double commanded_speed_m_s(const gait::GaitCommand& command) {
  return command.kind == gait::GaitKind::walk ? command.speed_m_s : 0.0;
}

bool walks(const gait::GaitCommand& command, const log::RunSummary& summary) {
  if (!summary.survived) return false;
  if (command.kind == gait::GaitKind::stand && !summary.steps.empty()) return false;
  const double commanded_m_s = commanded_speed_m_s(command);
  const double tolerance_m_s = commanded_m_s == 0.0 ? kAtZero_m_s : kShare * std::abs(commanded_m_s);
  return std::abs(summary.mean_speed_m_s - commanded_m_s) <= tolerance_m_s + kRounding_m_s;
}

}  // namespace stilt::experiments
