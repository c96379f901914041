#pragma once

#include <array>

#include "mpc_core/model/types.h"

namespace stilt::simulation {

/// Lengths of a leg.
struct LegLengths {
  double thigh_m = 0.0;
  double shin_m = 0.0;
};

/// Hip and knee angle of one leg.
struct LegAngles {
  double hip_rad = 0.0;
  double knee_rad = 0.0;
};

/// Joint angles of a foot forward_m ahead of the hip and below_m under it. The torso is pitched by pitch_rad
/// and the knee bent to a positive angle. With a = pitch + hip and b = a + knee the foot's position relative
/// to the hip is
///   (-thigh sin a - shin sin b, -(thigh cos a + shin cos b)).
/// Throws std::invalid_argument when the foot is out of the leg's reach.
[[nodiscard]] LegAngles leg_angles(const LegLengths& leg, double forward_m, double below_m, double pitch_rad);

/// Positions of both feet of a state, world frame: xL, zL, xR, zR.
[[nodiscard]] model::FeetVector foot_positions(const LegLengths& leg, const model::StateVector& state);

/// State that stands still: hip at x = 0 and base_height_m above z = 0, torso upright. The left foot is
/// half_width_m ahead of the hip and the right foot as far behind it, each on ground of the given height.
[[nodiscard]] model::StateVector standing_state(const LegLengths& leg, double base_height_m,
                                                double half_width_m,
                                                const std::array<double, model::kFeet>& ground_height_m = {});

}  // namespace stilt::simulation
