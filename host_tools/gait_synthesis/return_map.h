#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mpc_core/gait/hzd_gait.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Reduced state just after touch-down: pitch and joints, then their rates. The base follows from the stance
/// foot.
inline constexpr int kReducedStates = 2 * model::kAngles;
using ReducedState = Eigen::Matrix<double, kReducedStates, 1>;

/// Reduced state of a state just after touch-down.
[[nodiscard]] ReducedState reduce(const model::StateVector& x);
/// State with the left foot at rest at the origin.
[[nodiscard]] model::StateVector expand(const model::RobotModel& robot, const ReducedState& reduced);

struct ReturnMap {
  Eigen::Matrix<double, kReducedStates, kReducedStates> jacobian;
  std::vector<double> eigenvalue_magnitudes;  ///< descending, [10]
  [[nodiscard]] double spectral_radius() const { return eigenvalue_magnitudes.front(); }
};

/// Return map from just after one touch-down to just after the next, under the gait's output feedback,
/// linearised at `fixed_point` by central differences. The section is the touch-down of a foot. Starts off
/// the section are allowed, which adds an eigenvalue 0 to those of the map on the section. Nothing when a
/// perturbed step falls.
[[nodiscard]] std::optional<ReturnMap> linearise_return_map(const model::RobotModel& robot,
                                                            const gait::HzdGait& gait,
                                                            const ReducedState& fixed_point);

/// Fixed point of the return map near `start`, by Newton's method. Nothing when it does not converge.
[[nodiscard]] std::optional<ReducedState> find_fixed_point(const model::RobotModel& robot,
                                                           const gait::HzdGait& gait,
                                                           const ReducedState& start);

}  // namespace stilt::gait_synthesis
