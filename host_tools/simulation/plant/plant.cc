#include "host_tools/simulation/plant/plant.h"

#include <algorithm>
#include <cmath>

namespace stilt::simulation {
namespace {

constexpr double kLoaded_N = 5.0;
constexpr double kLowestHip = 0.6;  // share of the nominal height
constexpr double kLargestPitch_rad = 1.0;

void ignore_message(const char*) {}

/// Share of the distance to its set point that a first-order lag covers in a time step; 1 without a lag.
double share_of_step(double time_step_s, double time_constant_s) {
  return time_constant_s > 0.0 ? -std::expm1(-time_step_s / time_constant_s) : 1.0;
}

/// The multiple of the resolution next to a value; the value itself when the resolution is 0.
double quantised(double value, double resolution) {
  return resolution > 0.0 ? resolution * std::round(value / resolution) : value;
}

}  // namespace

const char* fall_text(Fall fall) {
  switch (fall) {
    case Fall::none:
      return "standing";
    case Fall::hip_too_low:
      return "hip too low";
    case Fall::pitch_too_large:
      return "pitch too large";
    case Fall::body_on_ground:
      return "body on the ground";
    case Fall::not_finite:
      return "state not finite";
  }
  return "";
}

Plant::Plant(const PlantModel& model, const PlantOptions& options, std::uint64_t seed)
    : options_(options),
      torque_limit_Nm_(model.torque_limit_Nm),
      nominal_hip_height_m_(model.nominal_hip_height_m),
      random_(seed) {
  mju_user_warning = ignore_message;  // prevents MuJoCo from writing a log file; fall() reports the causes of
                                      // warnings
  model_ = compile_mjcf(model.mjcf, index_);
  apply_options(*model_, options_);
  data_.reset(mj_makeData(model_.get()));
  if (options_.torque_limit_Nm) torque_limit_Nm_.setConstant(*options_.torque_limit_Nm);
  torque_limit_Nm_ *= options_.torque_limit_scale;
  delay_line_.resize(static_cast<std::size_t>(std::lround(options_.delay_s / options_.time_step_s)));
  drive_share_ = share_of_step(options_.time_step_s, options_.drive_time_constant_s);
  set_state(model::StateVector::Zero());
}

void Plant::set_state(const model::StateVector& state) {
  mj_resetData(model_.get(), data_.get());
  for (int i = 0; i < model::kPositions; ++i) {
    data_->qpos[i] = state[i];
    data_->qvel[i] = state[model::kPositions + i];
  }
  mj_step1(model_.get(), data_.get());
  measure_feet();
  contact_force_N_.setZero();
  slip_distance_m_ = 0.0;
  for (model::JointVector& torque : delay_line_) torque.setZero();
  delay_line_filled_ = false;
  delay_next_ = 0;
  drives_settled_ = false;
  commanded_torque_Nm_.setZero();
  applied_torque_Nm_.setZero();
  saturated_ = false;
}

void Plant::command_torque(const model::JointVector& torque_Nm) {
  commanded_torque_Nm_ = torque_Nm;
  if (delay_line_filled_) return;
  for (model::JointVector& torque : delay_line_) torque = torque_Nm;
  delay_line_filled_ = true;
}

void Plant::set_push(double force_N, PushPoint point) {
  push_N_ = force_N;
  push_point_ = point;
}

void Plant::step() {
  drive();
  apply_forces();
  const model::FeetVector force_before_N = contact_force_N_;
  const model::FeetVector position_before_m = foot_position_m_;
  mj_step2(model_.get(), data_.get());
  measure_contact();
  mj_step1(model_.get(), data_.get());
  measure_feet();
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const int x = 2 * foot;
    const bool loaded = force_before_N[x + 1] > kLoaded_N && contact_force_N_[x + 1] > kLoaded_N;
    if (loaded) slip_distance_m_ += std::abs(foot_position_m_[x] - position_before_m[x]);
  }
}

/// Largest torque of each motor at its speed, in the direction of the given torque.
model::JointVector Plant::limit_Nm(const model::JointVector& torque_Nm) const {
  model::JointVector largest_Nm = torque_limit_Nm_;
  if (options_.no_load_speed_rad_s == 0.0) return largest_Nm;
  for (int joint = 0; joint < model::kJoints; ++joint) {
    const double speed_rad_s = data_->qvel[model::kFirstJoint + joint];
    if (torque_Nm[joint] * speed_rad_s <= 0.0) continue;  // braking
    largest_Nm[joint] *= std::max(0.0, 1.0 - std::abs(speed_rad_s) / options_.no_load_speed_rad_s);
  }
  return largest_Nm;
}

model::JointVector Plant::limited(const model::JointVector& torque_Nm) const {
  const model::JointVector largest_Nm = limit_Nm(torque_Nm);
  return torque_Nm.cwiseMin(largest_Nm).cwiseMax(-largest_Nm);
}

model::JointVector Plant::delayed_command_Nm() {
  model::JointVector torque_Nm = commanded_torque_Nm_;
  if (delay_line_.empty()) return torque_Nm;
  std::swap(torque_Nm, delay_line_[delay_next_]);
  delay_next_ = (delay_next_ + 1) % delay_line_.size();
  return torque_Nm;
}

void Plant::drive() {
  const model::JointVector set_point_Nm = limited(delayed_command_Nm());
  saturated_ = (set_point_Nm.cwiseAbs().array() >= limit_Nm(set_point_Nm).array()).any();
  if (!drives_settled_ || drive_share_ == 1.0) {
    applied_torque_Nm_ = set_point_Nm;
  } else {
    applied_torque_Nm_ = limited(applied_torque_Nm_ + drive_share_ * (set_point_Nm - applied_torque_Nm_));
  }
  drives_settled_ = true;
}

void Plant::apply_forces() {
  for (int i = 0; i < model::kPositions; ++i) data_->qfrc_applied[i] = surroundings_force_[i];
  for (int joint = 0; joint < model::kJoints; ++joint) {
    data_->qfrc_applied[model::kFirstJoint + joint] += applied_torque_Nm_[joint];
  }
  if (push_N_ == 0.0) return;
  const mjtNum force[3] = {push_N_, 0.0, 0.0};
  const mjtNum no_torque[3] = {0.0, 0.0, 0.0};
  const mjtNum* hip = data_->xpos + 3 * index_.torso_body;
  const mjtNum along_torso[3] = {0.0, 0.0, push_above_hip_m(push_point_)};
  mjtNum point[3];
  mju_rotVecMat(point, along_torso, data_->xmat + 9 * index_.torso_body);
  mju_addTo3(point, hip);
  mj_applyFT(model_.get(), data_.get(), force, no_torque, point, index_.torso_body, data_->qfrc_applied);
}

void Plant::measure_contact() {
  contact_force_N_.setZero();
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    for (int foot = 0; foot < model::kFeet; ++foot) {
      const int geom = index_.foot_geom[static_cast<std::size_t>(foot)];
      if (contact.geom1 != geom && contact.geom2 != geom) continue;
      mjtNum wrench[6];
      mj_contactForce(model_.get(), data_.get(), i, wrench);
      mjtNum force[3];
      mju_rotVecMatT(force, wrench, contact.frame);
      const double sign = contact.geom2 == geom ? 1.0 : -1.0;  // MuJoCo reports the force on the second geom
      contact_force_N_[2 * foot] += sign * force[0];
      contact_force_N_[2 * foot + 1] += sign * force[2];
    }
  }
}

void Plant::measure_feet() {
  for (int foot = 0; foot < model::kFeet; ++foot) {
    const mjtNum* position = data_->site_xpos + 3 * index_.foot_site[static_cast<std::size_t>(foot)];
    foot_position_m_[2 * foot] = position[0];
    foot_position_m_[2 * foot + 1] = position[2];
  }
}

control::SensorReading Plant::read_sensors() {
  control::SensorReading reading;
  reading.time_s = data_->time;
  const PlantOptions& o = options_;
  const auto noisy = [this](double value, double noise, double resolution) {
    return quantised(value + noise * normal_(random_), resolution);
  };
  const auto own_or = [](double own, double common) { return own > 0.0 ? own : common; };
  for (int joint = 0; joint < model::kJoints; ++joint) {
    const int dof = model::kFirstJoint + joint;
    reading.joint_position_rad[joint] =
        noisy(data_->qpos[dof], o.encoder_noise_rad, o.encoder_resolution_rad);
    reading.joint_velocity_rad_s[joint] =
        noisy(data_->qvel[dof], o.encoder_velocity_noise_rad_s, o.encoder_velocity_resolution_rad_s);
  }
  reading.base_pitch_rad =
      noisy(data_->qpos[model::kFirstAngle] + o.base_pitch_bias_rad, o.base_pitch_noise_rad,
            own_or(o.base_pitch_resolution_rad, o.encoder_resolution_rad));
  reading.base_pitch_rate_rad_s =
      noisy(data_->qvel[model::kFirstAngle] + o.base_pitch_rate_bias_rad_s, o.base_pitch_rate_noise_rad_s,
            own_or(o.base_pitch_rate_resolution_rad_s, o.encoder_velocity_resolution_rad_s));
  return reading;
}

model::StateVector Plant::state() const {
  model::StateVector state;
  for (int i = 0; i < model::kPositions; ++i) {
    state[i] = data_->qpos[i];
    state[model::kPositions + i] = data_->qvel[i];
  }
  return state;
}

double Plant::time_step_s() const { return model_->opt.timestep; }

double Plant::energy_J() {
  mj_energyPos(model_.get(), data_.get());
  mj_energyVel(model_.get(), data_.get());
  return data_->energy[0] + data_->energy[1];
}

double Plant::ground_height_m(double x_m) const { return simulation::ground_height_m(options_, x_m); }

double Plant::mass_kg() const { return mj_getTotalmass(model_.get()); }

Eigen::Vector2d Plant::torso_com_m() const {
  const mjtNum* position = data_->xipos + 3 * index_.torso_body;
  return {position[0], position[2]};
}

double Plant::hip_above_ground_m() const { return data_->qpos[1] - ground_height_m(data_->qpos[0]); }

double Plant::fall_margin() const {
  const double height = (hip_above_ground_m() / nominal_hip_height_m_ - kLowestHip) / (1.0 - kLowestHip);
  return std::min(height, 1.0 - std::abs(data_->qpos[model::kFirstAngle]) / kLargestPitch_rad);
}

Fall Plant::fall() const {
  const bool engine_stopped = data_->warning[mjWARN_BADQPOS].number > 0 ||
                              data_->warning[mjWARN_BADQVEL].number > 0 ||
                              data_->warning[mjWARN_BADQACC].number > 0;
  if (engine_stopped || !state().allFinite()) return Fall::not_finite;
  if (hip_above_ground_m() < kLowestHip * nominal_hip_height_m_) return Fall::hip_too_low;
  if (std::abs(data_->qpos[model::kFirstAngle]) > kLargestPitch_rad) return Fall::pitch_too_large;
  for (int joint = model::kFirstJoint; joint < model::kPositions; ++joint) {
    const mjtNum* anchor = data_->xanchor + 3 * joint;
    if (anchor[2] < ground_height_m(anchor[0])) return Fall::body_on_ground;
  }
  const Eigen::Vector2d com_m = torso_com_m();
  return com_m.y() < ground_height_m(com_m.x()) ? Fall::body_on_ground : Fall::none;
}

}  // namespace stilt::simulation
