#include <algorithm>

#include "mpc_core/gait/reference.h"

namespace stilt::gait {
namespace {

using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

/// Converts the joints of a gait from stance leg first to left leg first.
model::JointVector by_side(const model::PositionVector& gait, bool left_stance) noexcept {
  model::JointVector joints = gait.tail<kJoints>();
  if (!left_stance) joints << gait.tail<2>(), gait.segment<2>(kFirstJoint);
  return joints;
}

}  // namespace

void HeuristicReference::follow_gait(double time_s, int phase, ReferencePoint& point) const noexcept {
  const ContactPhase& contact = schedule_->phase(phase);
  const double end_s = schedule_->end_s(phase);
  const double duration_s = end_s - contact.start_s;
  const double s = std::clamp((time_s - contact.start_s) / duration_s, 0.0, 1.0);
  const double middle_s = 0.5 * (contact.start_s + end_s);
  const double trim_m_s = knot_at(time_s).trim_m_s;
  const double speed_m_s = base_at(std::max(middle_s, time_s_)).speed_m_s + trim_m_s;
  const GaitPoint gait = library_->motion_at(speed_m_s, s);
  const int stance = contact.mode.left ? model::kLeft : model::kRight;
  const int swing = 1 - stance;

  // Lead of the base over its mean progress within a step, counted from the middle of the step.
  const double middle_x_m = library_->motion_at(speed_m_s, 0.5).position[0];
  const double lead_m = gait.position[0] - middle_x_m - speed_m_s * duration_s * (s - 0.5);
  const double x_m = base_at(time_s).x_m + lead_m;
  point.state.head<3>() << x_m, gait.position[1], gait.position[2];
  point.state.segment<kJoints>(kFirstJoint) = by_side(gait.position, contact.mode.left);
  point.state.segment<3>(kPositions) = gait.velocity.head<3>();
  point.state.tail<kJoints>() = by_side(gait.velocity, contact.mode.left);
  point.input.head<kJoints>() = by_side(gait.acceleration, contact.mode.left);
  point.input.segment<2>(kJoints + 2 * stance) = gait.force_N;

  model::NodeTerms<double> terms;
  model_->node(point.state.data(), point.input.data(), model_->constants.joint_parameters, terms);
  // A foot that lands to stand for good has the heuristics' place: as the gait lands it, the feet come
  // together.
  const bool stays = phase + 1 < schedule_->count() &&
                     schedule_->foot_interval(phase + 1, swing).end_s == ContactSchedule::kNever_s;
  for (int i = stays ? 1 : 0; i < 2; ++i) {
    point.foot_position_W_m[2 * swing + i] = terms.foot_position[2 * swing + i];
    point.foot_velocity_W_m_s[2 * swing + i] = terms.foot_velocity[2 * swing + i];
    point.foot_acceleration_W_m_s2[2 * swing + i] = terms.foot_acceleration[2 * swing + i];
  }
  const bool stands_already = schedule_->foot_interval(phase, stance).start_s <= time_s_;
  if (!stands_already) point.foot_position_W_m[2 * stance] = base_at(middle_s).x_m - middle_x_m;
}

}  // namespace stilt::gait
