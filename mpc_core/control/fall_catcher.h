#pragma once

#include "mpc_core/gait/command.h"
#include "mpc_core/gait/parameters.h"
#include "mpc_core/model/robot.h"

namespace stilt::control {

/// Where one foot must stand, so that the robot comes to rest above it:
///
///   x_c = x + L / (m z) sqrt(z / g)
///
/// x, z of the centre of mass; L the angular momentum of the whole body about the ground below it. L of a
/// point mass is m z v; a torso that tips adds its own. m, world. Sources: Pratt, Carff, Drakunov,
/// Goswami 2006, "Capture Point: A Step toward Humanoid Push Recovery". Gong, Grizzle 2021, "Angular Momentum
/// about the Contact Point for Control of Bipedal Locomotion". Real-time safe.
/// @param joint_parameters  as of the planner's model: armature and damping of the joints
[[nodiscard]] double capture_point_x_m(const model::RobotModel& robot, const double* joint_parameters,
                                       const model::StateVector& state) noexcept;

/// Lets a standing robot step when it would fall otherwise. On two point feet a robot stays where it is only
/// while its capture point lies between them. When that comes nearer than `catch_margin_m` to leaving the
/// feet, the command to stand becomes one to step in place. It becomes one to stand again when the base has
/// been slower than `catch_calm_m_s` for the time of a step. Real-time safe.
class FallCatcher {
 public:
  void reset() noexcept { *this = FallCatcher{}; }

  /// Once per plan. `standing_s`: time since when both feet stand by schedule; 0 when they do not.
  /// `base_m_s`: forward speed of the base. `capture_x_m`: of capture_point_x_m(). `feet`: [xL, zL, xR, zR],
  /// m, world.
  /// @return the command to follow
  [[nodiscard]] gait::GaitCommand update(double time_s, const gait::GaitCommand& command, double standing_s,
                                         double base_m_s, double capture_x_m, const model::FeetVector& feet,
                                         const gait::GaitParameters& parameters) noexcept;

  /// Direction of the fall that began the steps; none while the operator's command is followed.
  [[nodiscard]] gait::Fall fall() const noexcept { return fall_; }

 private:
  gait::Fall fall_ = gait::Fall::none;
  double moving_until_s_ = 0.0;  ///< last time at which the base was fast
};

}  // namespace stilt::control
