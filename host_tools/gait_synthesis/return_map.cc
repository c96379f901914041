#include "host_tools/gait_synthesis/return_map.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <functional>

#include "host_tools/gait_synthesis/hybrid_step.h"

namespace stilt::gait_synthesis {
namespace {

using Jacobian = Eigen::Matrix<double, kReducedStates, kReducedStates>;

std::optional<ReducedState> next(const model::RobotModel& robot, const gait::HzdGait& gait,
                                 const ReducedState& r) {
  const auto outcome = integrate_step(robot, gait, expand(robot, r));
  if (!outcome) return std::nullopt;
  return reduce(outcome->after);
}

std::optional<Jacobian> differentiate(const model::RobotModel& robot, const gait::HzdGait& gait,
                                      const ReducedState& at) {
  constexpr double kMove = 1e-5;
  Jacobian jacobian;
  for (int c = 0; c < kReducedStates; ++c) {
    ReducedState ahead = at;
    ReducedState behind = at;
    ahead[c] += kMove;
    behind[c] -= kMove;
    const auto after_ahead = next(robot, gait, ahead);
    const auto after_behind = next(robot, gait, behind);
    if (!after_ahead || !after_behind) return std::nullopt;
    jacobian.col(c) = (*after_ahead - *after_behind) / (2.0 * kMove);
  }
  return jacobian;
}

}  // namespace

ReducedState reduce(const model::StateVector& x) {
  ReducedState reduced;
  reduced << x.segment<model::kAngles>(model::kFirstAngle), x.tail<model::kAngles>();
  return reduced;
}

model::StateVector expand(const model::RobotModel& robot, const ReducedState& reduced) {
  model::StateVector x = model::StateVector::Zero();
  x.segment<model::kAngles>(model::kFirstAngle) = reduced.head<model::kAngles>();
  x.tail<model::kAngles>() = reduced.tail<model::kAngles>();
  model::KinematicsTerms<double> feet;
  robot.kinematics(x.data(), feet);
  for (int i = 0; i < 2; ++i) {
    x[i] = -feet.foot_position[i];
    x[model::kPositions + i] = -feet.foot_velocity[i];
  }
  return x;
}

std::optional<ReturnMap> linearise_return_map(const model::RobotModel& robot, const gait::HzdGait& gait,
                                              const ReducedState& fixed_point) {
  const auto jacobian = differentiate(robot, gait, fixed_point);
  if (!jacobian) return std::nullopt;
  ReturnMap map{*jacobian, {}};
  const auto eigenvalues = Eigen::EigenSolver<Jacobian>(*jacobian, false).eigenvalues();
  for (int i = 0; i < kReducedStates; ++i) map.eigenvalue_magnitudes.push_back(std::abs(eigenvalues[i]));
  std::sort(map.eigenvalue_magnitudes.begin(), map.eigenvalue_magnitudes.end(), std::greater<>());
  return map;
}

std::optional<ReducedState> find_fixed_point(const model::RobotModel& robot, const gait::HzdGait& gait,
                                             const ReducedState& start) {
  constexpr int kIterations = 20;
  constexpr double kConverged = 1e-11;
  ReducedState at = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const auto after = next(robot, gait, at);
    if (!after) return std::nullopt;
    const ReducedState change = *after - at;
    if (change.cwiseAbs().maxCoeff() < kConverged) return at;
    const auto jacobian = differentiate(robot, gait, at);
    if (!jacobian) return std::nullopt;
    at += (Jacobian::Identity() - *jacobian).lu().solve(change);
  }
  return std::nullopt;
}

}  // namespace stilt::gait_synthesis
