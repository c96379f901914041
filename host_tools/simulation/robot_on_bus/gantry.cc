#include "host_tools/simulation/robot_on_bus/gantry.h"

#include <algorithm>
#include <cmath>

namespace stilt::robot_on_bus {
namespace {

constexpr int kX = 0, kZ = 1, kPitch = model::kFirstAngle;

/// Moves a value by at most `step` towards `goal`.
double approach(double value, double goal, double step) {
  return value + std::clamp(goal - value, -step, step);
}

/// The hanging robot higher, its knees bent, its feet below its hips.
model::PositionVector lifted(const model::PositionVector& hanging, const GantryParameters& parameters) {
  model::PositionVector pose = hanging;
  pose[kZ] += parameters.lifting_clearance_m;
  for (int hip = model::kFirstJoint; hip < model::kPositions; hip += 2) {
    pose[hip] -= 0.5 * parameters.bent_knee_rad;
    pose[hip + 1] += parameters.bent_knee_rad;
  }
  return pose;
}

}  // namespace

const char* name(GantryState state) {
  switch (state) {
    case GantryState::holding:
      return "holding";
    case GantryState::lowering:
      return "lowering";
    case GantryState::releasing:
      return "releasing";
    case GantryState::off:
      return "off";
    case GantryState::lifting:
      return "lifting";
    case GantryState::settling:
      return "settling";
  }
  return "";
}

GantryParameters hanging_for_good() {
  GantryParameters parameters;
  parameters.clearance_m = 0.3;
  parameters.rest_stiffness_Nm_rad = 0.0;
  parameters.rest_damping_Nms_rad = 2.0;
  parameters.keeps = true;
  return parameters;
}

Gantry::Gantry(const GantryParameters& parameters, const model::StateVector& standing, double weight_N)
    : parameters_(parameters), target_(standing.head<model::kPositions>()), weight_N_(weight_N) {
  target_[kZ] += parameters_.clearance_m;
  hanging_ = target_;
  lifted_ = lifted(hanging_, parameters_);
}

model::StateVector Gantry::hanging() const {
  model::StateVector state = model::StateVector::Zero();
  state.head<model::kPositions>() = hanging_;
  return state;
}

double Gantry::rope_N(const model::StateVector& state) const {
  const double length_m = target_[kZ] - paid_out_m_ - state[kZ];
  const double force_N = weight_N_ + parameters_.rope_stiffness_N_m * length_m -
                         parameters_.rope_damping_Ns_m * state[model::kPositions + kZ];
  return std::clamp(force_N, 0.0, parameters_.rope_strength * weight_N_);
}

model::PositionVector Gantry::force(const model::StateVector& state) const {
  model::PositionVector force = model::PositionVector::Zero();
  if (state_ == GantryState::off) return force;
  const auto spring = [&](int i, double stiffness, double damping) {
    return stiffness * (target_[i] - state[i]) - damping * state[model::kPositions + i];
  };
  force[kX] = spring(kX, parameters_.guide_stiffness_N_m, parameters_.guide_damping_Ns_m);
  force[kZ] = rope_N(state);
  force[kPitch] = spring(kPitch, parameters_.pitch_stiffness_Nm_rad, parameters_.pitch_damping_Nms_rad);
  for (int i = model::kFirstJoint; i < model::kPositions; ++i) {
    force[i] = std::clamp(spring(i, parameters_.rest_stiffness_Nm_rad, parameters_.rest_damping_Nms_rad),
                          -parameters_.rest_limit_Nm, parameters_.rest_limit_Nm);
  }
  return strength_ * force;
}

void Gantry::elapse(const model::StateVector& state, bool torque_on, double duration_s) {
  switch (state_) {
    case GantryState::off:
      return;
    case GantryState::lifting:
      lift(state, duration_s);
      return;
    case GantryState::settling:
      settle(duration_s);
      return;
    case GantryState::releasing:
      strength_ -= duration_s / parameters_.release_s;
      if (strength_ > 0.0) return;
      strength_ = 0.0;
      state_ = GantryState::off;
      ++releases_;
      return;
    case GantryState::holding:
    case GantryState::lowering:
      break;
  }
  if (parameters_.keeps) return;
  pay_out(torque_on, duration_s);
  const bool carried = torque_on && rope_N(state) < parameters_.carried_share * weight_N_;
  carried_s_ = carried ? carried_s_ + duration_s : 0.0;
  if (carried_s_ >= parameters_.carried_s) state_ = GantryState::releasing;
}

void Gantry::pay_out(bool torque_on, double duration_s) {
  torque_on_s_ = torque_on ? torque_on_s_ + duration_s : 0.0;
  const bool lowering = torque_on_s_ >= parameters_.torque_on_s;
  state_ = lowering ? GantryState::lowering : GantryState::holding;
  paid_out_m_ = approach(paid_out_m_, lowering ? parameters_.lowering_limit_m : 0.0,
                         parameters_.lowering_speed_m_s * duration_s);
}

void Gantry::take(const model::StateVector& state) {
  target_ = lifted_;
  target_.head<model::kFirstJoint>() = state.head<model::kFirstJoint>();
  state_ = GantryState::lifting;
  paid_out_m_ = 0.0;
  strength_ = 1.0;
  torque_on_s_ = carried_s_ = 0.0;
}

void Gantry::lift(const model::StateVector& state, double duration_s) {
  target_[kZ] = approach(target_[kZ], lifted_[kZ], parameters_.lifting_speed_m_s * duration_s);
  target_[kPitch] = approach(target_[kPitch], lifted_[kPitch], parameters_.lifting_rate_rad_s * duration_s);
  const bool up = target_[kZ] == lifted_[kZ] && target_[kPitch] == lifted_[kPitch];
  const double off_rad = (state.segment<model::kJoints>(model::kFirstJoint) - lifted_.tail<model::kJoints>())
                             .cwiseAbs()
                             .maxCoeff();
  if (up && off_rad <= parameters_.bent_margin_rad) state_ = GantryState::settling;
}

void Gantry::settle(double duration_s) {
  target_[kZ] = approach(target_[kZ], hanging_[kZ], parameters_.lifting_speed_m_s * duration_s);
  if (target_[kZ] != hanging_[kZ]) return;
  const double step_rad = parameters_.rest_rate_rad_s * duration_s;
  for (int hip = model::kFirstJoint; hip < model::kPositions; hip += 2) {
    target_[hip] = approach(target_[hip], hanging_[hip], 0.5 * step_rad);
    target_[hip + 1] = approach(target_[hip + 1], hanging_[hip + 1], step_rad);
  }
  if (target_.tail<model::kJoints>() == hanging_.tail<model::kJoints>()) state_ = GantryState::holding;
}

}  // namespace stilt::robot_on_bus
