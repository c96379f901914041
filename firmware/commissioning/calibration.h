#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/commissioning/lag_fit.h"
#include "firmware/commissioning/session.h"
#include "firmware/configuration/edit.h"
#include "firmware/configuration/hardware.h"

/// Signs and offsets from what encoders read in known poses. Pure. With the shaft's angle at the joint
/// u = shaft / ratio
///
///   joint = direction u + offset_rad
namespace stilt::commissioning {

/// What a joint is moved to by hand.
enum class Reference {
  stops,  ///< its two end stops, which are the limits of the URDF
  marks,  ///< an alignment mark at angle 0: links in line; then backward
};

/// Two angles of a joint, the second one farther backward.
struct JointPoses {
  double first_rad = 0.0;
  double second_rad = 0.0;
  bool second_exact = true;      ///< otherwise the second is only known to be that far, or farther
  bool second_measured = false;  ///< by the person: good for the travel, not for the offset
};
[[nodiscard]] JointPoses joint_poses(Reference reference, double minimum_rad, double maximum_rad);

/// What the poses show of a joint.
enum class CalibrationFinding {
  correct,
  changed,             ///< the offset differs from the configuration's; the new one is valid
  other_sign,          ///< the joint turned against the configured sign, or was moved the other way
  dead_encoder,        ///< no encoder moved
  exchanged_encoders,  ///< another encoder moved
  wrong_travel,        ///< the encoder's angle between the poses is not that of the URDF, or measured
};
[[nodiscard]] const char* name(CalibrationFinding finding);

/// Sign and offset of a joint by its poses.
struct JointCalibration {
  CalibrationFinding finding = CalibrationFinding::correct;
  std::string sentence;
  bool reversed = false;  ///< by the poses
  double offset_rad = 0.0;
  double travel_share = 0.0;  ///< of the encoder between the poses, over that between their angles

  [[nodiscard]] bool good() const {
    return finding == CalibrationFinding::correct || finding == CalibrationFinding::changed;
  }
};

/// @param first, second  u of all joints in the two poses
/// @param place          as configured
/// @param ratio          of the joint's driver
[[nodiscard]] JointCalibration calibrate_joint(std::size_t joint, const JointPoses& poses,
                                               const hal::JointValues& first, const hal::JointValues& second,
                                               const configuration::JointParameters& place, double ratio);

/// What the poses show of the torso sensor.
enum class TorsoFinding {
  correct,
  changed,         ///< sign or offset differ from the configuration's; the new ones are valid
  not_tried,       ///< a joint is not calibrated
  silent,          ///< no pitch, or an old one
  legs_not_plumb,  ///< nothing to compare with
  dead,            ///< the torso moved, and the pitch did not
  unclear,         ///< the pitch does not follow the torso
  wrong_scale,
  late,
  wrong_rate,  ///< the rate is no derivative of the pitch
};
[[nodiscard]] const char* name(TorsoFinding finding);

/// What was read of the torso. Angles of the joints are calibrated.
struct TorsoReadings {
  double rest_pitch_rad = 0.0;  ///< by the sensor, all hanging at rest
  hal::JointValues rest_rad{};
  bool silent = false;  ///< at rest or while it rocked, the pitch was not current
  /// While it rocked, period_s apart: its angle by the left hip, and pitch and rate by the sensor.
  std::vector<double> torso_rad, pitch_rad, pitch_rate_rad_s;
  double period_s = 0.0;
};

/// What the readings come to.
struct TorsoMotion {
  double rest_pitch_rad = 0.0;
  hal::JointValues rest_rad{};
  bool silent = false;
  LagFit pitch{};  ///< of the sensor's pitch against the torso's angle, while the torso rocks
  LagFit rate{};   ///< of the integral of its rate against the same, both without their trends
};

/// The trend of the integral is the rate's bias. Takes long: for a robot whose drivers are off.
[[nodiscard]] TorsoMotion torso_motion(const TorsoReadings& readings);

/// Sign and offset of the torso sensor by its poses.
struct TorsoCalibration {
  TorsoFinding finding = TorsoFinding::not_tried;
  std::string sentence = "the torso sensor waits for calibrated joints";
  bool reversed = false;       ///< the pitch must change its sign
  bool rate_reversed = false;  ///< the rate must
  double offset_rad = 0.0;     ///< to be added to the pitch of the right sign
  TorsoMotion motion;

  [[nodiscard]] bool good() const {
    return finding == TorsoFinding::correct || finding == TorsoFinding::changed;
  }
};

/// How far limp legs that hang may be from plumb: friction holds them.
inline constexpr double kPlumb_rad = 0.15;

/// Whether both legs hang straight down, within kPlumb_rad, the torso at any pitch.
[[nodiscard]] bool legs_plumb(const hal::JointValues& rest_rad);
/// The torso's pitch by such legs.
[[nodiscard]] double plumb_pitch_rad(const hal::JointValues& rest_rad);

/// The legs are plumb lines: centres of mass lie on the links' axes, so that limp legs hang straight down.
/// The torso's pitch is then minus the angle of a hip. While the left thigh is held still in the world, its
/// hip shows how the torso moves.
/// @param sensor  as configured: some have one sign for pitch and rate, and a rate that differs is wrong_rate
[[nodiscard]] TorsoCalibration calibrate_torso(const TorsoMotion& motion,
                                               const configuration::TorsoSensorParameters& sensor);

/// The values for the configuration file: sign and offset of each joint. Of the torso sensor they are what
/// changes, under the keys that its device reads.
[[nodiscard]] std::vector<configuration::NewValue> new_values(
    const configuration::HardwareParameters& hardware,
    const std::array<JointCalibration, hal::kJoints>& joints, const TorsoCalibration& torso);

}  // namespace stilt::commissioning
