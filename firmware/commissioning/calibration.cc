#include "firmware/commissioning/calibration.h"

#include <cmath>
#include <numbers>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/wiring_verdict.h"
#include "firmware/configuration/channel_text.h"
#include "firmware/configuration/schema.h"
#include "firmware/control_loop/joint_names.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::commissioning {
namespace {

using configuration::NewValue;
using configuration::number_text;
using configuration::TorsoDevice;
using control_loop::kJointNames;

constexpr double kSwing_rad = 0.35;        // backward from a mark
constexpr double kMovedShare = 0.2;        // of the motion asked for: less is none
constexpr double kOtherShare = 0.5;        // of it, by another encoder
constexpr double kTravelTolerance = 0.05;  // of the travel between the stops
constexpr double kSameOffset_rad = 0.002;
constexpr double kSamePitch_rad = 0.03;   // friction holds a leg that far from plumb
constexpr double kDeadShare = 0.2;        // of the torso's motion
constexpr double kExplained = 0.8;        // of the pitch by the torso's motion
constexpr double kScaleTolerance = 1.25;  // a hand holds the thigh still that well
constexpr double kLate_s = 0.02;

const char* flag(bool value) { return value ? "true" : "false"; }

/// The encoder that moved instead, if any.
std::optional<std::size_t> moved_instead(std::size_t joint, const hal::JointValues& first,
                                         const hal::JointValues& second, double asked_rad) {
  for (std::size_t other = 0; other < hal::kJoints; ++other) {
    if (other != joint && std::abs(second[other] - first[other]) > kOtherShare * asked_rad) return other;
  }
  return std::nullopt;
}

void describe_change(std::size_t joint, const configuration::JointParameters& place,
                     JointCalibration& result) {
  const char* name = kJointNames[joint];
  if (result.reversed != place.reversed) {
    result.finding = CalibrationFinding::other_sign;
    result.sentence = formatted(
        "%s turned against its sign: forward and backward were exchanged, or %s.reversed must be %s; jog %s, "
        "change what the jog says, and calibrate again",
        name, name, flag(result.reversed), name);
    return;
  }
  if (std::abs(result.offset_rad - place.offset_rad) <= kSameOffset_rad) {
    result.sentence = formatted("%s is correct", name);
    return;
  }
  result.finding = CalibrationFinding::changed;
  result.sentence =
      formatted("%s: offset_rad is %.4f, and was %.4f", name, result.offset_rad, place.offset_rad);
}

bool near_one(double factor) { return factor < kScaleTolerance && factor > 1 / kScaleTolerance; }

TorsoCalibration found(const TorsoMotion& motion, TorsoFinding finding, const std::string& sentence) {
  TorsoCalibration result;
  result.motion = motion;
  result.finding = finding;
  result.sentence = sentence;
  return result;
}

bool is_encoder(const configuration::TorsoSensorParameters& sensor) {
  return sensor.device == TorsoDevice::canopen_encoder || sensor.encoder_joint >= 0;
}

bool is_imu(const configuration::TorsoSensorParameters& sensor) {
  return sensor.device == TorsoDevice::xsens_can || sensor.device == TorsoDevice::vectornav;
}

hal::TorsoSensorTraits traits_of(const configuration::TorsoSensorParameters& sensor) {
  configuration::HardwareParameters hardware;
  hardware.torso_sensor = sensor;
  return hal::torso_sensor_traits(configuration::robot_wiring(hardware));
}

/// How late the rate is by the configuration alone: a mean over a window is that of its middle.
double half_window_s(const configuration::TorsoSensorParameters& sensor) {
  return traits_of(sensor).has_rate ? 0 : 0.5 * sensor.rate_window_s;
}

/// The sensor's share of the rate's delay counts: a robot walks with the longest half window.
std::optional<std::string> lag_finding(const TorsoMotion& motion,
                                       const configuration::TorsoSensorParameters& sensor) {
  const double own_s = half_window_s(sensor);
  if (motion.pitch.delay_s <= kLate_s && motion.rate.delay_s <= kLate_s + own_s) return std::nullopt;
  const std::string window =
      own_s > 0 ? formatted(", %.0f of them by torso_sensor.rate_window_s", 1e3 * own_s) : "";
  return formatted(
      "late torso sensor: pitch by %.0f ms, rate by %.0f ms%s; at most %.0f%s are usable: look at its "
      "filter, its rate and its cable",
      1e3 * motion.pitch.delay_s, 1e3 * motion.rate.delay_s, window.c_str(), 1e3 * kLate_s,
      own_s > 0 ? " more" : "");
}

/// One setting reverses pitch and rate.
bool has_one_sign(const configuration::TorsoSensorParameters& sensor) {
  return is_encoder(sensor) || is_imu(sensor) || sensor.pitch_rate == "none";
}

std::string scale_mend(const configuration::TorsoSensorParameters& sensor) {
  if (is_encoder(sensor)) return "multiply torso_sensor.encoder_ratio by that";
  if (is_imu(sensor)) return "look at torso_sensor.imu_axis and how the unit is mounted";
  return "divide the scale of torso_sensor.pitch by that";
}

std::string rate_mend(const configuration::TorsoSensorParameters& sensor) {
  if (is_imu(sensor)) return "look at torso_sensor.imu_axis and how the unit is mounted";
  if (sensor.device == TorsoDevice::canopen_encoder) return "look at torso_sensor.encoder_speed_rad_s";
  if (is_encoder(sensor)) return "look at torso_sensor.encoder_ratio and the encoder's own settings";
  return "look at torso_sensor.pitch_rate";
}

/// What no change of sign and offset mends.
std::optional<TorsoCalibration> unusable(const TorsoMotion& motion,
                                         const configuration::TorsoSensorParameters& sensor) {
  const LagFit& pitch = motion.pitch;
  const LagFit& rate = motion.rate;
  if (motion.silent || !std::isfinite(motion.rest_pitch_rad)) {
    return found(motion, TorsoFinding::silent,
                 "silent torso sensor: no new pitch comes from it; stiltd scan reports more");
  }
  if (!legs_plumb(motion.rest_rad)) {
    return found(
        motion, TorsoFinding::legs_not_plumb,
        formatted("the legs do not hang plumb: hips at %.2f and %.2f rad, knees at %.2f and %.2f; help "
                  "them by hand, or mend the joints' offsets first",
                  motion.rest_rad[0], motion.rest_rad[2], motion.rest_rad[1], motion.rest_rad[3]));
  }
  if (pitch.signal_spread < kDeadShare * pitch.reference_spread) {
    return found(motion, TorsoFinding::dead,
                 "dead torso sensor: the torso rocked, and its pitch stood still");
  }
  if (pitch.explained < kExplained) {
    return found(
        motion, TorsoFinding::unclear,
        formatted("the torso sensor does not follow the torso: %.0f %% of its pitch is the torso's motion "
                  "against the left thigh; hold the thigh still, and look whether the sensor is fixed",
                  100 * pitch.explained));
  }
  if (!near_one(std::abs(pitch.gain))) {
    return found(motion, TorsoFinding::wrong_scale,
                 formatted("wrong scale of the torso sensor: its pitch turns by %.3g rad per rad; %s",
                           std::abs(pitch.gain), scale_mend(sensor).c_str()));
  }
  if (const auto late = lag_finding(motion, sensor)) return found(motion, TorsoFinding::late, *late);
  if (!near_one(std::abs(rate.gain)) || rate.explained < kExplained) {
    return found(motion, TorsoFinding::wrong_rate,
                 formatted("wrong pitch rate of the torso sensor: its integral turns by %.3g rad per rad; %s",
                           std::abs(rate.gain), rate_mend(sensor).c_str()));
  }
  if (has_one_sign(sensor) && pitch.gain * rate.gain < 0) {
    return found(
        motion, TorsoFinding::wrong_rate,
        "wrong pitch rate of the torso sensor: its sign is not that of the pitch; " + rate_mend(sensor));
  }
  return std::nullopt;
}

NewValue channel(const char* key, const std::string& old, double factor, double offset) {
  return {"torso_sensor", key, '"' + configuration::transformed_channel(old, factor, offset) + '"'};
}

void add_torso(const configuration::TorsoSensorParameters& sensor, const TorsoCalibration& torso,
               std::vector<NewValue>& values) {
  const double sign = torso.reversed ? -1 : 1;
  if (is_encoder(sensor)) {
    const double offset_rad = sign * sensor.encoder_offset_rad + torso.offset_rad;
    const double period_rad = traits_of(sensor).pitch_period_rad;
    values.push_back({"torso_sensor", "encoder_reversed", flag(sensor.encoder_reversed != torso.reversed)});
    values.push_back(
        {"torso_sensor", "encoder_offset_rad", number_text(std::remainder(offset_rad, period_rad))});
    return;
  }
  if (is_imu(sensor)) {
    const double offset_rad = sign * sensor.imu_offset_rad + torso.offset_rad;
    values.push_back({"torso_sensor", "imu_reversed", flag(sensor.imu_reversed != torso.reversed)});
    values.push_back(
        {"torso_sensor", "imu_offset_rad", number_text(std::remainder(offset_rad, 2 * std::numbers::pi))});
    return;
  }
  values.push_back(channel("pitch", sensor.pitch, sign, torso.offset_rad));
  if (torso.rate_reversed && sensor.pitch_rate != "none") {
    values.push_back(channel("pitch_rate", sensor.pitch_rate, -1, 0));
  }
}

}  // namespace

double plumb_pitch_rad(const hal::JointValues& rest_rad) { return -0.5 * (rest_rad[0] + rest_rad[2]); }

bool legs_plumb(const hal::JointValues& rest_rad) {
  return std::abs(rest_rad[0] - rest_rad[2]) < kPlumb_rad && std::abs(rest_rad[1]) < kPlumb_rad &&
         std::abs(rest_rad[3]) < kPlumb_rad;
}

const char* name(CalibrationFinding finding) {
  constexpr std::array<const char*, 6> kNames = {
      "correct", "changed", "other_sign", "dead_encoder", "exchanged_encoders", "wrong_travel"};
  return kNames[static_cast<std::size_t>(finding)];
}

const char* name(TorsoFinding finding) {
  constexpr std::array<const char*, 10> kNames = {"correct",        "changed",   "not_tried", "silent",
                                                  "legs_not_plumb", "dead",      "unclear",   "wrong_scale",
                                                  "late",           "wrong_rate"};
  return kNames[static_cast<std::size_t>(finding)];
}

JointPoses joint_poses(Reference reference, double minimum_rad, double maximum_rad) {
  if (reference == Reference::stops) return {minimum_rad, maximum_rad, true};
  return {0, kSwing_rad, false};
}

JointCalibration calibrate_joint(std::size_t joint, const JointPoses& poses, const hal::JointValues& first,
                                 const hal::JointValues& second, const configuration::JointParameters& place,
                                 double ratio) {
  const double asked_rad = poses.second_rad - poses.first_rad;
  const double read_rad = second[joint] - first[joint];
  JointCalibration result;
  result.reversed = place.reversed;
  result.offset_rad = place.offset_rad;
  result.travel_share = std::abs(read_rad) / asked_rad;
  const char* name = kJointNames[joint];
  if (result.travel_share < kMovedShare) {
    const auto other = moved_instead(joint, first, second, asked_rad);
    result.finding = other ? CalibrationFinding::exchanged_encoders : CalibrationFinding::dead_encoder;
    result.sentence =
        other ? formatted(
                    "exchanged encoders: the %s moved, and the encoder of %s reports it; exchange the "
                    "encoders' "
                    "cables, or the identifiers of their drivers",
                    link_name(joint), kJointNames[*other])
              : formatted(
                    "dead encoder: the %s moved, and the encoder of %s stood still; look at its cable and "
                    "magnet",
                    link_name(joint), name);
    return result;
  }
  const bool known = poses.second_exact || poses.second_measured;
  if (known && std::abs(result.travel_share - 1) > kTravelTolerance) {
    result.finding = CalibrationFinding::wrong_travel;
    const std::string where =
        poses.second_exact
            ? formatted("between stops that are %.3f rad apart by the URDF; a stop was not reached",
                        asked_rad)
            : formatted("where you measured %.3f rad; that was read wrong", asked_rad);
    result.sentence =
        formatted("wrong travel: the encoder of %s turned by %.3f rad ", name, std::abs(read_rad)) + where +
        formatted(", or its driver's ratio is about %.4g instead of %.4g", ratio * result.travel_share,
                  ratio);
    return result;
  }
  result.reversed = read_rad < 0;
  const double direction = result.reversed ? -1 : 1;
  result.offset_rad = poses.first_rad - direction * first[joint];
  if (poses.second_exact) {
    result.offset_rad = 0.5 * (result.offset_rad + poses.second_rad - direction * second[joint]);
  }
  describe_change(joint, place, result);
  return result;
}

TorsoMotion torso_motion(const TorsoReadings& readings) {
  TorsoMotion motion{
      .rest_pitch_rad = readings.rest_pitch_rad, .rest_rad = readings.rest_rad, .silent = readings.silent};
  std::vector<double> integral_rad;
  double sum_rad = 0;
  for (const double rate_rad_s : readings.pitch_rate_rad_s) {
    sum_rad += rate_rad_s * readings.period_s;
    integral_rad.push_back(sum_rad);
  }
  motion.pitch = fit_lag(readings.torso_rad, readings.pitch_rad, readings.period_s);
  motion.rate = fit_lag(detrended(readings.torso_rad), detrended(integral_rad), readings.period_s);
  return motion;
}

TorsoCalibration calibrate_torso(const TorsoMotion& motion,
                                 const configuration::TorsoSensorParameters& sensor) {
  if (auto bad = unusable(motion, sensor)) return *bad;
  TorsoCalibration result = found(motion, TorsoFinding::correct, "the torso sensor is correct");
  result.reversed = motion.pitch.gain < 0;
  result.rate_reversed = motion.rate.gain < 0;
  const double offset_rad =
      plumb_pitch_rad(motion.rest_rad) - (result.reversed ? -1 : 1) * motion.rest_pitch_rad;
  if (std::abs(offset_rad) > kSamePitch_rad) result.offset_rad = offset_rad;
  if (!result.reversed && !result.rate_reversed && result.offset_rad == 0) return result;
  result.finding = TorsoFinding::changed;
  result.sentence = "torso sensor:";
  if (result.reversed) result.sentence += " reversed pitch, upside down;";
  if (result.rate_reversed) result.sentence += " reversed rate;";
  result.sentence += formatted(" offset of the pitch %.4f rad by gravity", result.offset_rad);
  return result;
}

std::vector<NewValue> new_values(const configuration::HardwareParameters& hardware,
                                 const std::array<JointCalibration, hal::kJoints>& joints,
                                 const TorsoCalibration& torso) {
  std::vector<NewValue> values;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    values.push_back({kJointNames[joint], "reversed", flag(joints[joint].reversed)});
    values.push_back({kJointNames[joint], "offset_rad", number_text(joints[joint].offset_rad)});
  }
  if (torso.finding == TorsoFinding::changed) add_torso(hardware.torso_sensor, torso, values);
  return values;
}

}  // namespace stilt::commissioning
