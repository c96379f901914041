#include <optional>
#include <string>

#include "firmware/configuration/hardware_consistency.h"
#include "firmware/configuration/schema.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::configuration {
namespace {

/// One kind of driver and the keys that limit it.
struct DriverKeys {
  std::string_view section, kp_range, kd_range, moteus_kp, moteus_kd;
};
constexpr DriverKeys kHip = {"hip_driver", "hip_driver.kp_range_Nm_rad", "hip_driver.kd_range_Nms_rad",
                             "hip_driver.moteus_kp_Nm_rev", "hip_driver.moteus_kd_Nms_rev"};
constexpr DriverKeys kKnee = {"knee_driver", "knee_driver.kp_range_Nm_rad", "knee_driver.kd_range_Nms_rad",
                              "knee_driver.moteus_kp_Nm_rev", "knee_driver.moteus_kd_Nms_rev"};

/// A gain of the supervisor, at the joint, per rad.
struct Gain {
  std::string_view key;
  double value = 0;
};

/// Where the most that a driver gives stands, in its own unit.
struct Limit {
  std::string_view key;
  std::string_view unit;
  double most = 0;
  double per_rad = 1;  ///< in units of `unit`: 1, or 2 pi for gains a revolution
};

/// At the shaft a gain is that of the joint divided by ratio^2 (hal::JointWiring).
void check(const Gain& gain, const Limit& limit, const DriverKeys& keys, double ratio,
           std::vector<Contradiction>& found) {
  const double scale = limit.per_rad / (ratio * ratio);
  const double asked = gain.value * scale;
  if (asked <= limit.most) return;
  found.push_back({{gain.key, limit.key},
                   std::string(gain.key) + " = " + number_text(gain.value) + " asks " + number_text(asked) +
                       " " + std::string(limit.unit) + " of the shaft of a " + std::string(keys.section) +
                       ", which gives at most " + std::string(limit.key) + " = " + number_text(limit.most) +
                       "; set that to what the driver's own configuration allows, or " +
                       std::string(gain.key) + " to at most " + number_text(limit.most / scale)});
}

void check_driver(const hal::JointDriver& driver, double ratio, const DriverKeys& keys,
                  const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found) {
  const std::optional<hal::GainLimits> limits =
      hal::visit_driver(driver, [](const auto& any) { return gain_limits(any); });
  if (!limits) return;
  const bool moteus = std::holds_alternative<hal::moteus::MoteusDriver>(driver);
  const Limit kp = {moteus ? keys.moteus_kp : keys.kp_range, limits->kp_unit, limits->kp, limits->unit_rad};
  const Limit kd = {moteus ? keys.moteus_kd : keys.kd_range, limits->kd_unit, limits->kd, limits->unit_rad};
  check({"supervisor.hold_kp_Nm_rad", supervisor.hold_kp_Nm_rad}, kp, keys, ratio, found);
  check({"supervisor.hold_kd_Nms_rad", supervisor.hold_kd_Nms_rad}, kd, keys, ratio, found);
  check({"supervisor.damping_kd_Nms_rad", supervisor.damping_kd_Nms_rad}, kd, keys, ratio, found);
}

}  // namespace

void check_gains(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                 std::vector<Contradiction>& found) {
  const hal::RobotWiring wiring = robot_wiring(hardware);
  check_driver(wiring.joints[0].driver, hardware.hip.ratio, kHip, supervisor, found);
  check_driver(wiring.joints[1].driver, hardware.knee.ratio, kKnee, supervisor, found);
}

}  // namespace stilt::configuration
