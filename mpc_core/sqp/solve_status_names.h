#pragma once

#include <array>

/// Words for people, in the order of SolveStatus (solve_report.h).
namespace stilt::sqp {

inline constexpr std::array<const char*, 6> kSolveStatusNames = {
    "converged", "iteration limit", "step rejected", "not finite", "not convex", "infeasible"};

}  // namespace stilt::sqp
