#include "mpc_core/gait/hzd_gait.h"

#include "mpc_core/gait/swing.h"

namespace stilt::gait {

using model::kJoints;
using model::kPositions;

GaitPoint motion_at(const HzdGait& gait, double s) noexcept {
  const GaitMotion& motion = gait.motion;
  const BernsteinBasis basis(motion.degree, s);
  const double rate = gait.step_time_s > 0.0 ? 1.0 / gait.step_time_s : 0.0;
  GaitPoint point;
  for (int i = 0; i < kPositions; ++i) {
    const BezierPoint b = basis.evaluate(motion.position[i]);
    point.position[i] = b.value;
    point.velocity[i] = b.slope * rate;
    point.acceleration[i] = b.curvature * rate * rate;
  }
  for (int j = 0; j < kJoints; ++j) point.torque_Nm[j] = basis.value(motion.torque_Nm[j]);
  for (int i = 0; i < 2; ++i) point.force_N[i] = basis.value(motion.force_N[i]);
  return point;
}

OutputPoint outputs_at(const GaitOutputs& outputs, double s) noexcept {
  OutputPoint point;
  for (int j = 0; j < kJoints; ++j) {
    const BezierPoint b = evaluate_bezier(outputs.angle_rad[j], outputs.degree, s);
    point.angle_rad[j] = b.value;
    point.slope_rad[j] = b.slope;
    point.curvature_rad[j] = b.curvature;
  }
  return point;
}

OutputPoint placement_share(double s) noexcept {
  constexpr int kSwingHip = 2;
  OutputPoint point;
  if (s <= 0.0) return point;
  const Motion share = minimum_jerk(0.0, 1.0, s < 1.0 ? s : 1.0, 1.0);
  point.angle_rad[kSwingHip] = share.position;
  point.slope_rad[kSwingHip] = s < 1.0 ? share.velocity : 0.0;
  point.curvature_rad[kSwingHip] = s < 1.0 ? share.acceleration : 0.0;
  return point;
}

}  // namespace stilt::gait
