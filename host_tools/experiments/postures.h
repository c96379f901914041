#pragma once

#include "host_tools/recording/run_record.h"
#include "host_tools/web/plot/svg_plot.h"

namespace stilt::experiments {

/// Positions of the joints in a posture, world frame, m.
struct Posture {
  double hip_x_m = 0.0, hip_z_m = 0.0, pitch_rad = 0.0;
  double knee_x_m[model::kFeet] = {}, knee_z_m[model::kFeet] = {};
  double foot_x_m[model::kFeet] = {}, foot_z_m[model::kFeet] = {};
};

/// The posture of a state.
[[nodiscard]] Posture posture_of(const log::RobotDrawing& robot, const model::StateVector& state);

/// The posture at the end of a plan. The knees follow from hip and feet, bent backward.
[[nodiscard]] Posture end_posture(const log::RobotDrawing& robot, const log::PlanSnapshot& plan);

/// Adds torso and legs to a plot, moved by shift_m along x; the left leg in colour --a, the right one in --c.
void draw(const log::RobotDrawing& robot, const Posture& posture, double shift_m, plot::Plot& figure);

}  // namespace stilt::experiments
