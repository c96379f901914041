#pragma once

#include <expected>
#include <optional>
#include <string>

#include "firmware/commissioning/calibration.h"
#include "firmware/commissioning/dialog.h"

/// A person moves the joints of the limp robot to known angles, and rocks its torso: signs and offsets
/// follow. Ordinary threads; why so: docs/decisions/0021-commissioning.md
namespace stilt::commissioning {

/// What calibrate() needs to know.
struct CalibrationRequest {
  Reference reference = Reference::stops;
  configuration::HardwareParameters hardware;
  hal::JointValues minimum_rad{};  ///< ends of the travel by the URDF
  hal::JointValues maximum_rad{};
};

/// What the person's hands have shown. The drivers are off by then: to judge the torso takes long.
struct CalibrationReadings {
  std::array<JointCalibration, hal::kJoints> joints;
  std::optional<TorsoReadings> torso;  ///< nothing: a joint is not calibrated
};

/// What calibrate() found, by joint and of the torso.
struct CalibrationReport {
  Reference reference = Reference::stops;
  std::array<JointCalibration, hal::kJoints> joints;
  TorsoCalibration torso;
  std::vector<configuration::NewValue> values;  ///< for the configuration file; empty unless all is good

  [[nodiscard]] bool good() const;
};

/// Brings the drivers up, asks for one pose after the other, and turns them off: no frame asks for a torque
/// or a gain. The torso is tried when all joints are good.
[[nodiscard]] std::expected<CalibrationReadings, CommandFailure> read_poses(Session& session,
                                                                            const CalibrationRequest& request,
                                                                            Person& person);

/// Signs and offsets from the readings. Pure.
[[nodiscard]] CalibrationReport calibrated(const CalibrationRequest& request,
                                           const CalibrationReadings& readings);

/// Both, one after the other.
[[nodiscard]] std::expected<CalibrationReport, CommandFailure> calibrate(Session& session,
                                                                         const CalibrationRequest& request,
                                                                         Person& person);

[[nodiscard]] std::string to_text(const CalibrationReport& report);
/// @param file  that the values were written to; empty: none
[[nodiscard]] std::string to_json(const CalibrationReport& report, const std::string& file);

}  // namespace stilt::commissioning
