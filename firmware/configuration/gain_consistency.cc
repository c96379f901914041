#include <cmath>
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

/// Of hip_L, knee_L, hip_R, knee_R.
constexpr std::string_view kFactors[hal::kJoints] = {"hip_L.torque_factor", "knee_L.torque_factor",
                                                     "hip_R.torque_factor", "knee_R.torque_factor"};
constexpr double kRounding = 1e-9;  // relative: a quotient may round to more than the limit

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
  double per_rad = 1;  ///< in units of `unit`: 1, or 2 pi for gains per revolution
};

/// The joint of a kind of driver whose motor gives least per torque asked: it is asked the largest gains.
struct Weakest {
  std::string_view factor_key;
  double factor = 1;
  double ratio = 1;
};

/// Three digits behind the point, away from the limit: what is asked upward, what would do downward.
std::string short_text(double value, double (*round)(double)) {
  constexpr double kDigits = 1e3;
  constexpr double kSmall = 0.1;
  const double scaled = kDigits * value;
  const double near = std::round(scaled);
  if (value < kSmall) return number_text(value);
  return number_text((std::abs(scaled - near) < kRounding * scaled ? near : round(scaled)) / kDigits);
}

/// At the shaft a gain is that of the joint divided by ratio^2 torque_factor (hal::JointWiring).
void check(const Gain& gain, const Limit& limit, const DriverKeys& keys, const Weakest& joint,
           std::vector<Contradiction>& found) {
  const double scale = limit.per_rad / (joint.ratio * joint.ratio * joint.factor);
  const double asked = gain.value * scale;
  if (asked <= limit.most * (1 + kRounding)) return;
  const bool factored = joint.factor != 1;
  const std::string of =
      factored
          ? " of the shaft of " + std::string(joint.factor_key.substr(0, joint.factor_key.find('.'))) + " (" +
                std::string(joint.factor_key) + " = " + number_text(joint.factor) + "), whose driver gives"
          : " of the shaft of a " + std::string(keys.section) + ", which gives";
  std::vector<std::string_view> involved = {gain.key, limit.key};
  if (factored) involved.insert(involved.begin(), joint.factor_key);
  found.push_back({involved, std::string(gain.key) + " = " + number_text(gain.value) + " asks " +
                                 short_text(asked, std::ceil) + " " + std::string(limit.unit) + of +
                                 " at most " + std::string(limit.key) + " = " + number_text(limit.most) +
                                 "; set that to what the driver's own configuration allows, or " +
                                 std::string(gain.key) + " to at most " +
                                 short_text(limit.most / scale, std::floor)});
}

Weakest weakest(const HardwareParameters& hardware, std::size_t joint, double ratio) {
  const double left = hardware.joint[joint].torque_factor;
  const double right = hardware.joint[joint + 2].torque_factor;
  return right < left ? Weakest{kFactors[joint + 2], right, ratio} : Weakest{kFactors[joint], left, ratio};
}

void check_driver(const hal::JointDriver& driver, const Weakest& joint, const DriverKeys& keys,
                  const supervisor::SupervisorParameters& supervisor, std::vector<Contradiction>& found) {
  const std::optional<hal::GainLimits> limits =
      hal::visit_driver(driver, [](const auto& any) { return gain_limits(any); });
  if (!limits) return;
  const bool moteus = std::holds_alternative<hal::moteus::MoteusDriver>(driver);
  const Limit kp = {moteus ? keys.moteus_kp : keys.kp_range, limits->kp_unit, limits->kp, limits->unit_rad};
  const Limit kd = {moteus ? keys.moteus_kd : keys.kd_range, limits->kd_unit, limits->kd, limits->unit_rad};
  check({"supervisor.hold_kp_Nm_rad", supervisor.hold_kp_Nm_rad}, kp, keys, joint, found);
  check({"supervisor.hold_kd_Nms_rad", supervisor.hold_kd_Nms_rad}, kd, keys, joint, found);
  check({"supervisor.damping_kd_Nms_rad", supervisor.damping_kd_Nms_rad}, kd, keys, joint, found);
}

}  // namespace

void check_gains(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                 std::vector<Contradiction>& found) {
  const hal::RobotWiring wiring = robot_wiring(hardware);
  check_driver(wiring.joints[0].driver, weakest(hardware, 0, hardware.hip.ratio), kHip, supervisor, found);
  check_driver(wiring.joints[1].driver, weakest(hardware, 1, hardware.knee.ratio), kKnee, supervisor, found);
}

}  // namespace stilt::configuration
