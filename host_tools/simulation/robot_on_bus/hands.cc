#include "host_tools/simulation/robot_on_bus/hands.h"

#include <algorithm>

namespace stilt::robot_on_bus {
namespace {

constexpr int kPitch = model::kFirstAngle, kHipLeft = model::kFirstJoint;
constexpr double kStiffness_Nm_rad = 2000.0;
constexpr double kDamping_Nms_rad = 60.0;
constexpr double kTorsoStiffness_Nm_rad = 20000.0;  // a gantry holds it, too
constexpr double kTorsoDamping_Nms_rad = 300.0;

}  // namespace

void Hands::elapse(const model::StateVector& state, double duration_s) {
  const double step_rad = kHandSpeed_rad_s * duration_s;
  for (int angle = kPitch; angle < model::kPositions; ++angle) {
    const std::optional<double>& target_rad = target_rad_[index(angle)];
    std::optional<double>& held_rad = held_rad_[index(angle)];
    if (!target_rad) continue;
    if (!held_rad) held_rad = state[angle];
    *held_rad += std::clamp(*target_rad - *held_rad, -step_rad, step_rad);
  }
  if (holds_left_thigh_ && !thigh_rad_) thigh_rad_ = state[kPitch] + state[kHipLeft];
}

model::PositionVector Hands::force(const model::StateVector& state) const {
  model::PositionVector force_Nm = model::PositionVector::Zero();
  for (int angle = kPitch; angle < model::kPositions; ++angle) {
    const std::optional<double>& held_rad = held_rad_[index(angle)];
    if (!held_rad) continue;
    const bool torso = angle == kPitch;
    force_Nm[angle] = (torso ? kTorsoStiffness_Nm_rad : kStiffness_Nm_rad) * (*held_rad - state[angle]) -
                      (torso ? kTorsoDamping_Nms_rad : kDamping_Nms_rad) * state[model::kPositions + angle];
  }
  if (thigh_rad_) {
    const double rate_rad_s = state[model::kPositions + kPitch] + state[model::kPositions + kHipLeft];
    const double torque_Nm =
        kStiffness_Nm_rad * (*thigh_rad_ - state[kPitch] - state[kHipLeft]) - kDamping_Nms_rad * rate_rad_s;
    force_Nm[kPitch] += torque_Nm;
    force_Nm[kHipLeft] += torque_Nm;
  }
  return force_Nm;
}

}  // namespace stilt::robot_on_bus
