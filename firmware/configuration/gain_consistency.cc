#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "firmware/configuration/hardware_consistency.h"
#include "firmware/configuration/schema.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::configuration {
namespace {

/// One kind of driver and the keys that limit it.
struct DriverKeys {
  std::string_view section, ratio, kp_range, kd_range, moteus_kp, moteus_kd;
};
constexpr DriverKeys kHip = {"hip_driver",
                             "hip_driver.ratio",
                             "hip_driver.kp_range_Nm_rad",
                             "hip_driver.kd_range_Nms_rad",
                             "hip_driver.moteus_kp_Nm_rev",
                             "hip_driver.moteus_kd_Nms_rev"};
constexpr DriverKeys kKnee = {"knee_driver",
                              "knee_driver.ratio",
                              "knee_driver.kp_range_Nm_rad",
                              "knee_driver.kd_range_Nms_rad",
                              "knee_driver.moteus_kp_Nm_rev",
                              "knee_driver.moteus_kd_Nms_rev"};

/// Of hip_L, knee_L, hip_R, knee_R.
constexpr std::string_view kFactors[hal::kJoints] = {"hip_L.torque_factor", "knee_L.torque_factor",
                                                     "hip_R.torque_factor", "knee_R.torque_factor"};
constexpr double kRounding = 1e-9;  // relative: a quotient may round to more than the limit
constexpr double kLeastSteps = 20;  // of a gain: one step less is 5 %

/// A gain of the supervisor, at the joint, per rad.
struct Gain {
  std::string_view key;
  double value = 0;
};

/// Where the most that a driver gives stands, in its own unit, and the step of the field that carries it.
struct Limit {
  DriverProtocol protocol;
  std::string_view key;
  std::string_view unit;
  double most = 0;
  double step = 0;
  double per_rad = 1;  ///< in units of `unit`: 1, or 2 pi for gains per revolution
};

/// A joint and what its motor gives per torque asked.
struct Joint {
  std::string_view factor_key;
  double factor = 1;
  double ratio = 1;
};

/// Both joints of a kind of driver: the one that is asked the largest gains, and the smallest.
struct Joints {
  Joint weakest;
  Joint strongest;
};

/// Three digits behind the point, below 0.1 three in all. What is asked goes away from the limit, what would
/// do to its side that is right.
std::string short_text(double value, double (*round)(double)) {
  constexpr double kSmall = 0.1;
  const double digits = value < kSmall ? std::pow(10.0, 2.0 - std::floor(std::log10(value))) : 1e3;
  const double scaled = digits * value;
  const double near = std::round(scaled);
  return number_text((std::abs(scaled - near) < kRounding * scaled ? near : round(scaled)) / digits);
}

/// At the shaft a gain is that of the joint divided by ratio^2 torque_factor (hal::JointWiring).
double at_shaft(const Limit& limit, const Joint& joint) {
  return limit.per_rad / (joint.ratio * joint.ratio * joint.factor);
}

/// What a gain asks of which shaft; what its driver does follows.
std::string asked_text(const Gain& gain, const std::string& asked, const Limit& limit, const DriverKeys& keys,
                       const Joint& joint) {
  const std::string text = std::string(gain.key) + " = " + number_text(gain.value) + " asks " + asked + " " +
                           std::string(limit.unit) + " of the shaft of ";
  if (joint.factor == 1) return text + "a " + std::string(keys.section) + ", which";
  const std::string key(joint.factor_key);
  return text + key.substr(0, key.find('.')) + " (" + key + " = " + number_text(joint.factor) +
         "), whose driver";
}

void report(std::vector<std::string_view> involved, const Joint& joint, const std::string& message,
            std::vector<Contradiction>& found) {
  if (joint.factor != 1) involved.insert(involved.begin(), joint.factor_key);
  found.push_back({std::move(involved), message});
}

/// How the largest gain of a driver is raised. That of a Damiao or AK is the same in every firmware.
std::string more_text(DriverProtocol protocol) {
  if (protocol == DriverProtocol::moteus) return "that to what the driver's own configuration allows, or ";
  if (protocol == DriverProtocol::mit_mini_cheetah) return "that to the range of the driver's firmware, or ";
  return "";
}

void check_most(const Gain& gain, const Limit& limit, const DriverKeys& keys, const Joint& joint,
                std::vector<Contradiction>& found) {
  const double scale = at_shaft(limit, joint);
  const double asked = gain.value * scale;
  if (asked <= limit.most * (1 + kRounding)) return;
  report({gain.key, limit.key}, joint,
         asked_text(gain, short_text(asked, std::ceil), limit, keys, joint) + " gives at most " +
             std::string(limit.key) + " = " + number_text(limit.most) + "; set " + more_text(limit.protocol) +
             std::string(gain.key) + " to at most " + short_text(limit.most / scale, std::floor),
         found);
}

/// A command has up to one step less than what is asked. A gain of 0 arrives as it is.
void check_least(const Gain& gain, const Limit& limit, const DriverKeys& keys, const Joint& joint,
                 std::vector<Contradiction>& found) {
  const double scale = at_shaft(limit, joint);
  const double asked = gain.value * scale;
  const double least = kLeastSteps * limit.step;
  if (gain.value == 0 || asked >= least * (1 - kRounding)) return;
  std::string remedy;
  if (limit.protocol == DriverProtocol::moteus) {
    remedy = std::string(limit.key) + " = " + number_text(limit.most) +
             ", and the driver's own gain, to at most " + short_text(limit.most * asked / least, std::floor) +
             ", or ";
  } else if (joint.ratio > 1) {
    remedy = std::string(keys.ratio) + " = " + number_text(joint.ratio) + " to at most " +
             short_text(joint.ratio * std::sqrt(asked / least), std::floor) +
             " (1 where the driver counts its output), or ";
  }
  report({gain.key, keys.ratio, limit.key}, joint,
         asked_text(gain, short_text(asked, std::floor), limit, keys, joint) + " has steps of " +
             short_text(limit.step, std::round) + ", and fewer than " + number_text(kLeastSteps) +
             " come out coarse or as 0; set " + remedy + std::string(gain.key) + " to at least " +
             short_text(least / scale, std::ceil),
         found);
}

void check(const Gain& gain, const Limit& limit, const DriverKeys& keys, const Joints& joints,
           std::vector<Contradiction>& found) {
  check_most(gain, limit, keys, joints.weakest, found);
  check_least(gain, limit, keys, joints.strongest, found);
}

Joints joints_of(const HardwareParameters& hardware, std::size_t joint, double ratio) {
  const Joint left = {kFactors[joint], hardware.joint[joint].torque_factor, ratio};
  const Joint right = {kFactors[joint + 2], hardware.joint[joint + 2].torque_factor, ratio};
  return right.factor < left.factor ? Joints{right, left} : Joints{left, right};
}

void check_driver(const hal::JointDriver& driver, DriverProtocol protocol, const Joints& joints,
                  const DriverKeys& keys, const supervisor::SupervisorParameters& supervisor,
                  std::vector<Contradiction>& found) {
  const std::optional<hal::GainLimits> limits =
      hal::visit_driver(driver, [](const auto& any) { return gain_limits(any); });
  if (!limits) return;
  const bool moteus = protocol == DriverProtocol::moteus;
  const std::string_view kp_key = moteus ? keys.moteus_kp : keys.kp_range;
  const std::string_view kd_key = moteus ? keys.moteus_kd : keys.kd_range;
  const Limit kp = {protocol, kp_key, limits->kp_unit, limits->kp, limits->kp_step, limits->unit_rad};
  const Limit kd = {protocol, kd_key, limits->kd_unit, limits->kd, limits->kd_step, limits->unit_rad};
  check({"supervisor.hold_kp_Nm_rad", supervisor.hold_kp_Nm_rad}, kp, keys, joints, found);
  check({"supervisor.hold_kd_Nms_rad", supervisor.hold_kd_Nms_rad}, kd, keys, joints, found);
  check({"supervisor.damping_kd_Nms_rad", supervisor.damping_kd_Nms_rad}, kd, keys, joints, found);
}

}  // namespace

void check_gains(const HardwareParameters& hardware, const supervisor::SupervisorParameters& supervisor,
                 std::vector<Contradiction>& found) {
  const hal::RobotWiring wiring = robot_wiring(hardware);
  check_driver(wiring.joints[0].driver, hardware.hip.protocol, joints_of(hardware, 0, hardware.hip.ratio),
               kHip, supervisor, found);
  check_driver(wiring.joints[1].driver, hardware.knee.protocol, joints_of(hardware, 1, hardware.knee.ratio),
               kKnee, supervisor, found);
}

}  // namespace stilt::configuration
