#pragma once

#include "mpc_core/gait/command.h"
#include "mpc_core/gait/parameters.h"
#include "mpc_core/model/types.h"

namespace stilt::control {

/// Lets a standing robot step when it would fall otherwise. On two point feet a robot stays where it is only
/// while its capture point lies between them:
///
///   x_c = x + v sqrt(z / g)
///
/// x, v, z of the base. When x_c comes nearer than `catch_margin_m` to leaving the feet, the command to stand
/// becomes one to step in place. It becomes one to stand again when the base has been slower than
/// `catch_calm_m_s` for the time of a step. Source of the capture point: Pratt, Carff, Drakunov, Goswami
/// 2006, "Capture Point: A Step toward Humanoid Push Recovery". Real-time safe.
class FallCatcher {
 public:
  void reset() noexcept { *this = FallCatcher{}; }

  /// Once per plan. `standing_s`: time since when both feet stand by schedule; 0 when they do not. `feet`:
  /// [xL, zL, xR, zR], m, world.
  /// @return the command to follow
  [[nodiscard]] gait::GaitCommand update(double time_s, const gait::GaitCommand& command, double standing_s,
                                         const model::StateVector& state, const model::FeetVector& feet,
                                         const gait::GaitParameters& parameters) noexcept;

  /// Direction of the fall that began the steps; none while the operator's command is followed.
  [[nodiscard]] gait::Fall fall() const noexcept { return fall_; }

 private:
  gait::Fall fall_ = gait::Fall::none;
  double moving_until_s_ = 0.0;  ///< last time at which the base was fast
};

}  // namespace stilt::control
