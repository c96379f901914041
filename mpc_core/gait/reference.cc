#include "mpc_core/gait/reference.h"

#include <algorithm>
#include <cmath>

namespace stilt::gait {
namespace {

using model::kFirstJoint;
using model::kPositions;

bool stands(const ContactPhase& phase) noexcept { return phase.gait == GaitKind::stand; }

}  // namespace

Eigen::Vector2d leg_angles(double foot_x_m, double foot_z_m, double thigh_m, double shin_m) noexcept {
  const double reach = std::hypot(foot_x_m, foot_z_m);
  const double d = std::clamp(reach, std::abs(thigh_m - shin_m) + 1e-9, thigh_m + shin_m - 1e-9);
  // Triangle of hip, knee and foot: the angle between the thigh and the hip-foot line, and the bend of the
  // knee.
  const double at_hip = std::acos((thigh_m * thigh_m + d * d - shin_m * shin_m) / (2.0 * thigh_m * d));
  const double at_knee = std::acos((thigh_m * thigh_m + shin_m * shin_m - d * d) / (2.0 * thigh_m * shin_m));
  constexpr double kPi = 3.14159265358979323846;
  const double line = std::atan2(-foot_x_m, -foot_z_m);  // a foot at -x: positive rotation about +y
  return {line - at_hip, kPi - at_knee};
}

model::StateVector standing_state(const model::RobotConstants& robot, double base_height_m, double pitch_rad,
                                  double half_width_m, bool left_ahead) noexcept {
  model::StateVector state = model::StateVector::Zero();
  state[1] = base_height_m;
  state[2] = pitch_rad;
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const bool ahead = (foot == model::kLeft) == left_ahead;
    const Eigen::Vector2d angles = leg_angles(ahead ? half_width_m : -half_width_m, -base_height_m,
                                              robot.thigh_length_m, robot.shin_length_m);
    state[kFirstJoint + 2 * foot] = angles[0] - pitch_rad;
    state[kFirstJoint + 2 * foot + 1] = angles[1];
  }
  return state;
}

void HeuristicReference::prepare(const model::RobotConstants& robot, const ContactSchedule& schedule,
                                 const GaitCommand& command, const GaitParameters& gait,
                                 const ReferenceParameters& parameters, double time_s,
                                 const model::StateVector& state, const model::FeetVector& foot_position_W_m,
                                 double speed_m_s, double speed_trim_m_s) noexcept {
  schedule_ = &schedule;
  command_ = command;
  gait_ = gait;
  parameters_ = parameters;
  time_s_ = time_s;
  weight_N_ = robot.total_mass_kg * model::kGravity_m_s2;
  measured_feet_ = foot_position_W_m;
  nominal_ = standing_state(robot, parameters.base_height_m, parameters.base_pitch_rad, 0.0, true);
  // When standing, the reference of the base lies midway between the feet; when stepping, it starts at the
  // measured base.
  speed_excess_m_s_ = state[kPositions] - speed_m_s;
  const bool standing = stands(schedule.phase(schedule.index_at(time_s)));
  const double x_m = standing ? 0.5 * (foot_position_W_m[0] + foot_position_W_m[2]) : state[0];
  prepare_speed(time_s, x_m, followed_speed_m_s(speed_m_s, state[kPositions]), speed_trim_m_s);
}

void HeuristicReference::prepare_speed(double time_s, double x_m, double speed_m_s,
                                       double trim_m_s) noexcept {
  const int first = schedule_->index_at(time_s);
  SpeedKnot knot{time_s, x_m, speed_m_s, 0.0, 0.0};
  knot_count_ = 0;
  for (int phase = first; phase < schedule_->count(); ++phase) {
    const ContactPhase& contact = schedule_->phase(phase);
    if (phase > first) {
      const BaseMotion base = advance(knot, contact.start_s);
      knot = {contact.start_s, base.x_m, base.speed_m_s, 0.0, 0.0};
    }
    knot.target_m_s = contact.gait == GaitKind::walk ? command_.speed_m_s : 0.0;
    knot.trim_m_s = stands(contact) ? 0.0 : trim_m_s;
    knots_[knot_count_++] = knot;
  }
}

HeuristicReference::BaseMotion HeuristicReference::advance(const SpeedKnot& from,
                                                           double time_s) const noexcept {
  const double elapsed = time_s - from.time_s;
  const double change = from.target_m_s - from.speed_m_s;
  const double rate = std::copysign(parameters_.speed_ramp_m_s2, change);
  const double ramp_s = std::abs(change) / parameters_.speed_ramp_m_s2;
  const double trim_m = elapsed * from.trim_m_s;
  if (elapsed < ramp_s) {  // also extrapolates into the past, at the present speed
    const double acceleration = elapsed > 0.0 ? rate : 0.0;
    return {from.x_m + trim_m + elapsed * (from.speed_m_s + 0.5 * acceleration * elapsed),
            from.speed_m_s + acceleration * elapsed};
  }
  const double ramp_m = ramp_s * (from.speed_m_s + 0.5 * rate * ramp_s);
  return {from.x_m + trim_m + ramp_m + (elapsed - ramp_s) * from.target_m_s, from.target_m_s};
}

const HeuristicReference::SpeedKnot& HeuristicReference::knot_at(double time_s) const noexcept {
  int knot = 0;
  while (knot + 1 < knot_count_ && knots_[knot + 1].time_s <= time_s) ++knot;
  return knots_[knot];
}

double HeuristicReference::speed_at(double time_s) const noexcept { return base_at(time_s).speed_m_s; }

double HeuristicReference::followed_speed_m_s(double reference_m_s, double measured_m_s) const noexcept {
  const double band_m_s = parameters_.speed_follow_band_m_s;
  const double within_m_s = std::clamp(reference_m_s, measured_m_s - band_m_s, measured_m_s + band_m_s);
  return std::min(within_m_s, std::max(reference_m_s, parameters_.speed_follow_max_m_s));
}

double HeuristicReference::foothold_shift_m(const Interval& contact) const noexcept {
  const double step_s = gait_.single_support_s + gait_.double_support_s;
  // At the instant of a switch the next contact is one step away, up to rounding: it gets the whole shift.
  constexpr double kRounding = 1e-6;
  const int steps_ahead = static_cast<int>((contact.start_s - time_s_) / step_s - kRounding);
  double shift_m = parameters_.foothold_gain_s * speed_excess_m_s_;
  for (int step = 0; step < steps_ahead; ++step) shift_m *= parameters_.foothold_gain_decay;
  return std::clamp(shift_m, -parameters_.foothold_shift_max_m, parameters_.foothold_shift_max_m);
}

double HeuristicReference::foothold_x_m(int foot, const Interval& contact) const noexcept {
  if (contact.end_s <= time_s_) {  // already lifted off: it stood below the hip half a step earlier
    const double duration_s = std::min(contact.end_s - contact.start_s, gait_.single_support_s);
    return base_at(contact.end_s - 0.5 * duration_s).x_m;
  }
  if (contact.start_s <= time_s_) return measured_feet_[2 * foot];
  const int first = schedule_->index_at(contact.start_s);
  for (int phase = first; phase < schedule_->count() && schedule_->phase(phase).mode[foot]; ++phase) {
    if (!stands(schedule_->phase(phase))) continue;
    const double below_hip_m = base_at(schedule_->phase(phase).start_s).x_m;
    if (phase != first) return below_hip_m;
    // The foot that lands last before a stand is placed ahead of the other. The weights of the other terms
    // keep about half of that distance: asked for is twice the wanted one.
    const int other = 1 - foot;
    const bool other_stands = schedule_->foot_interval(phase, other).start_s <= time_s_;
    const double apart_m = 2.0 * 2.0 * gait_.stand_half_width_m;
    return (other_stands ? measured_feet_[2 * other] : below_hip_m) + apart_m;
  }
  return base_at(0.5 * (contact.start_s + contact.end_s)).x_m + foothold_shift_m(contact);
}

void HeuristicReference::foot_reference(double time_s, int phase, int foot, Motion& x,
                                        Motion& z) const noexcept {
  const Interval interval = schedule_->foot_interval(phase, foot);
  if (schedule_->phase(phase).mode[foot]) {
    x = {foothold_x_m(foot, interval), 0.0, 0.0};
    z = {0.0, 0.0, 0.0};
    return;
  }
  const double duration_s = interval.end_s - interval.start_s;
  const double s = std::clamp((time_s - interval.start_s) / duration_s, 0.0, 1.0);
  const int before = schedule_->index_at(interval.start_s) - 1;
  const int after = schedule_->index_at(interval.end_s);
  const Interval next = schedule_->foot_interval(after, foot);
  const Interval last = before >= 0 ? schedule_->foot_interval(before, foot)
                                    : Interval{interval.start_s - duration_s, interval.start_s};
  x = minimum_jerk(foothold_x_m(foot, last), foothold_x_m(foot, next), s, duration_s);
  z = swing_height(gait_.swing_height_m, gait_.touchdown_velocity_m_s, s, duration_s);
}

ReferencePoint HeuristicReference::evaluate(double time_s, int phase) const noexcept {
  ReferencePoint point;
  const BaseMotion base = base_at(time_s);
  point.state = nominal_;
  point.state[0] = base.x_m;
  point.state[kPositions] = base.speed_m_s + knot_at(time_s).trim_m_s;

  const model::ContactMode mode = schedule_->phase(phase).mode;
  point.input.setZero();
  for (int foot = 0; foot < model::kFeet; ++foot) {
    if (mode[foot]) point.input[model::kJoints + 2 * foot + 1] = weight_N_ / mode.count();
    Motion x{};
    Motion z{};
    foot_reference(time_s, phase, foot, x, z);
    point.foot_position_W_m.segment<2>(2 * foot) << x.position, z.position;
    point.foot_velocity_W_m_s.segment<2>(2 * foot) << x.velocity, z.velocity;
    point.foot_acceleration_W_m_s2.segment<2>(2 * foot) << x.acceleration, z.acceleration;
  }
  if (library_ != nullptr && mode.count() == 1) follow_gait(time_s, phase, point);
  return point;
}

}  // namespace stilt::gait
