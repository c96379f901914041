#include "mpc_core/control/fall_catcher.h"

#include <algorithm>
#include <cmath>

namespace stilt::control {
namespace {

constexpr double kLeastHeight_m = 0.1;  ///< of the centre of mass: a robot that lies has a capture point, too

gait::Fall predicted_fall(double capture_x_m, const model::FeetVector& feet, double margin_m) noexcept {
  if (capture_x_m > std::max(feet[0], feet[2]) - margin_m) return gait::Fall::forward;
  if (capture_x_m < std::min(feet[0], feet[2]) + margin_m) return gait::Fall::backward;
  return gait::Fall::none;
}

}  // namespace

// docs/decisions/0039-capture-point-of-the-whole-body.md
double capture_point_x_m(const model::RobotModel& robot, const double* joint_parameters,
                         const model::StateVector& state) noexcept {
  model::MassMatrixTerms<double> terms;
  robot.mass_matrix(state.data(), joint_parameters, terms);
  using Square = Eigen::Matrix<double, model::kPositions, model::kPositions, Eigen::RowMajor>;
  const Eigen::Map<const Square> mass(terms.mass_matrix[0]);
  const model::PositionVector momentum = mass * state.tail<model::kPositions>();
  // A pitch rate moves the centre of mass, which lies (a, b) from the base, by (b, -a).
  const double mass_kg = mass(0, 0);
  const double ahead_m = -mass(1, 2) / mass_kg;
  const double height_m = std::max(state[1] + mass(0, 2) / mass_kg, kLeastHeight_m);
  const double angular_momentum = momentum[2] + state[1] * momentum[0] + ahead_m * momentum[1];
  const double velocity_m_s = angular_momentum / (mass_kg * height_m);
  return state[0] + ahead_m + velocity_m_s * std::sqrt(height_m / model::kGravity_m_s2);
}

gait::GaitCommand FallCatcher::update(double time_s, const gait::GaitCommand& command, double standing_s,
                                      double base_m_s, double capture_x_m, const model::FeetVector& feet,
                                      const gait::GaitParameters& parameters) noexcept {
  if (!parameters.catch_falls || command.kind != gait::GaitKind::stand) {
    reset();
    return command;
  }
  // The estimate needs a moment after a landing.
  constexpr double kSettled_s = 0.06;
  if (fall_ == gait::Fall::none && standing_s > kSettled_s) {
    fall_ = predicted_fall(capture_x_m, feet, parameters.catch_margin_m);
    moving_until_s_ = time_s;
  }
  if (fall_ == gait::Fall::none) return command;
  if (std::abs(base_m_s) > parameters.catch_calm_m_s) moving_until_s_ = time_s;
  const double step_s = parameters.single_support_s + parameters.double_support_s;
  if (time_s - moving_until_s_ > step_s) {
    reset();
    return command;
  }
  return {gait::GaitKind::step, 0.0};
}

}  // namespace stilt::control
