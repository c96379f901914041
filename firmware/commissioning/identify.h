#pragma once

#include <array>
#include <expected>
#include <string>
#include <vector>

#include "firmware/commissioning/drive_fit.h"
#include "firmware/commissioning/session.h"
#include "firmware/configuration/edit.h"
#include "firmware/configuration/hardware.h"
#include "firmware/supervisor/parameters.h"

/// One joint after the other moves on the gantry, slowly and then quickly, the others held: the numbers of
/// its drive follow. Ordinary threads; why so: docs/decisions/0021-commissioning.md
namespace stilt::commissioning {

/// What identify() needs to know.
struct IdentificationRequest {
  const model::RobotModel* robot = nullptr;
  double torque_share = 0.3;                         ///< of the joints' limits: most torque
  double kp_Nm_rad = 0.0;                            ///< of all motions, closed here
  supervisor::SupervisorParameters supervisor = {};  ///< when an encoder is frozen, or jumps
  configuration::HardwareParameters hardware;        ///< with the active torque factors
};

/// What was asked of the joints and read of them. The drivers are off by then: the fit takes long, and
/// nothing may wait for it that has torque.
struct Excitation {
  std::array<DriveRecord, hal::kJoints> records;  ///< of each joint while it moved
  hal::JointValues peak_torque_Nm{};
  double period_s = 0.0;
};

/// What identify() found, by joint.
struct IdentificationReport {
  std::array<DriveNumbers, hal::kJoints> drives;
  hal::JointValues peak_torque_Nm{};
  std::vector<configuration::NewValue> values;  ///< for the configuration file; empty unless all is known
  std::vector<std::string> findings;            ///< sentences; empty: all is good
};

/// Brings the drivers up, excites each joint, and turns them off. Torque, travel and speed stay within
/// limits. Beyond them, at a fault, at the emergency stop and without a pitch the robot is limp and the error
/// names the cause. So it is once the loop has stood still.
[[nodiscard]] std::expected<Excitation, std::string> excite(Session& session,
                                                            const IdentificationRequest& request);

/// The numbers of the drives from their motions, and what they mean. Pure.
[[nodiscard]] IdentificationReport identified(const IdentificationRequest& request,
                                              const Excitation& excitation);

/// Both, one after the other.
[[nodiscard]] std::expected<IdentificationReport, std::string> identify(Session& session,
                                                                        const IdentificationRequest& request);

/// What the numbers mean: values for the configuration, and what is wrong.
void judge(const IdentificationRequest& request, IdentificationReport& report);

[[nodiscard]] std::string to_text(const IdentificationReport& report);
/// @param file  that the values were written to; empty: none
[[nodiscard]] std::string to_json(const IdentificationReport& report, const std::string& file);

}  // namespace stilt::commissioning
