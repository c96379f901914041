#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/identify.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/commissioning/values_report.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/schema.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

using Json = nlohmann::ordered_json;
using configuration::DriverProtocol;
using configuration::NewValue;
using control_loop::kJointNames;

constexpr double kClearFactor = 0.2;  // half width of the torque factor's interval
constexpr double kRightFactor = 0.1;  // away from 1: masses of a URDF are no better
constexpr double kAlike = 0.1;        // of the mean, beside the intervals: as well as legs are measured
constexpr double kAlikeFriction_Nm = 0.3;
constexpr double kAlikeDamping_Nms_rad = 0.25;

bool clear(const DriveNumbers& drive) {
  return drive.samples > 0 && drive.torque_factor.half_width < kClearFactor;
}

/// Mean over a joint of both legs, at least 0, as TOML.
std::string mean_text(const IdentificationReport& report, std::size_t joint,
                      Estimate DriveNumbers::* number) {
  constexpr double kDigits = 1e4;
  const double mean = 0.5 * ((report.drives[joint].*number).value + (report.drives[joint + 2].*number).value);
  return configuration::number_text(std::round(kDigits * std::max(0.0, mean)) / kDigits);
}

/// An armature was found of a joint that has none in the URDF: no scale makes one of it.
bool lacks_armature(const model::RobotModel& robot, const IdentificationReport& report, std::size_t joint) {
  const Estimate& found = report.drives[joint].armature_kg_m2;
  return !(robot.constants.joint_parameters[joint] > 0) && found.value > found.half_width;
}

/// Of the joints that have an armature in the URDF; empty: of none, or others lack one.
std::string armature_scale_text(const model::RobotModel& robot, const IdentificationReport& report) {
  double found = 0, of_urdf = 0;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (lacks_armature(robot, report, joint)) return "";
    const double armature_kg_m2 = robot.constants.joint_parameters[joint];
    if (!(armature_kg_m2 > 0)) continue;
    found += std::max(0.0, report.drives[joint].armature_kg_m2.value);
    of_urdf += armature_kg_m2;
  }
  return of_urdf > 0 ? configuration::number_text(std::round(1e4 * found / of_urdf) / 1e4) : "";
}

bool differ(const Estimate& a, const Estimate& b, double at_least) {
  const double mean = 0.5 * std::abs(a.value + b.value);
  return std::abs(a.value - b.value) > a.half_width + b.half_width + std::max(at_least, kAlike * mean);
}

/// A number of which the file has one for both legs.
struct SharedNumber {
  const char* name;
  const char* unit;
  Estimate DriveNumbers::* number;
  double at_least;  ///< a smaller difference is none
};
constexpr std::array kSharedNumbers = {
    SharedNumber{"friction", "Nm", &DriveNumbers::coulomb_friction_Nm, kAlikeFriction_Nm},
    SharedNumber{"damping", "Nm s/rad", &DriveNumbers::damping_Nms_rad, kAlikeDamping_Nms_rad},
    SharedNumber{"armature", "kg m^2", &DriveNumbers::armature_kg_m2, 0}};

void compare_legs(IdentificationReport& report) {
  for (const SharedNumber& shared : kSharedNumbers) {
    for (const std::size_t left : {0u, 1u}) {
      const Estimate& a = report.drives[left].*shared.number;
      const Estimate& b = report.drives[left + 2].*shared.number;
      if (!differ(a, b, shared.at_least)) continue;
      report.findings.push_back(
          formatted("the %s of %s is %.3g %s and of %s %.3g %s, and the file has one for both, %.3g: look "
                    "what differs between the legs, and repeat",
                    shared.name, kJointNames[left], a.value, shared.unit, kJointNames[left + 2], b.value,
                    shared.unit, 0.5 * (a.value + b.value)));
    }
  }
}

/// Mean armature of both legs over the URDF's.
Estimate armature_share(const model::RobotModel& robot, const IdentificationReport& report,
                        std::size_t joint) {
  const Estimate& left = report.drives[joint].armature_kg_m2;
  const Estimate& right = report.drives[joint + 2].armature_kg_m2;
  const double of_urdf =
      robot.constants.joint_parameters[joint] + robot.constants.joint_parameters[joint + 2];
  return {(left.value + right.value) / of_urdf, (left.half_width + right.half_width) / of_urdf};
}

void compare_hips_and_knees(const model::RobotModel& robot, IdentificationReport& report) {
  const auto armatures = std::span(robot.constants.joint_parameters).first(hal::kJoints);
  if (!std::ranges::all_of(armatures, [](double armature) { return armature > 0; })) return;
  const Estimate hips = armature_share(robot, report, 0), knees = armature_share(robot, report, 1);
  if (!differ(hips, knees, 0)) return;
  report.findings.push_back(
      formatted("the armature of the hips is %.3g times that of the URDF and of the knees %.3g times, and "
                "robot.armature_scale is one for both: write rotor inertia or gear ratio of the joints into "
                "the URDF, and repeat",
                hips.value, knees.value));
}

void name_lacking_armatures(const model::RobotModel& robot, IdentificationReport& report) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (!lacks_armature(robot, report, joint)) continue;
    const double found = report.drives[joint].armature_kg_m2.value;
    report.findings.push_back(formatted(
        "the URDF has no rotor inertia of %s, whose armature is %.3g kg m^2: write rotorInertia = %.3g "
        "/ mechanicalReduction^2 into its transmission, and repeat; no armature_scale is written",
        kJointNames[joint], found, found));
  }
}

/// The vendor's setting of the torque constant, and what makes it right.
std::string vendors_setting(DriverProtocol protocol, double factor) {
  if (protocol == DriverProtocol::moteus) return formatted("divide motor.Kv of its moteus by %.3f", factor);
  if (protocol == DriverProtocol::odrive) {
    return formatted("multiply axis0.config.motor.torque_constant of its ODrive by %.3f", factor);
  }
  return formatted("multiply the torque constant in its driver by %.3f, where the vendor's tool can", factor);
}

/// @param factor  found, beside the active one
void judge_factor(const configuration::HardwareParameters& hardware, std::size_t joint, double factor,
                  std::vector<std::string>& findings, std::vector<NewValue>& values) {
  const char* name = kJointNames[joint];
  const double whole = factor * hardware.joint[joint].torque_factor;
  if (whole < configuration::kLeastTorqueFactor || whole > configuration::kMostTorqueFactor) {
    findings.push_back(
        formatted("%s gives %.2f Nm per Nm asked: more than its torque_factor mends, 0.5 to 2; look at the "
                  "ratio and at the motor that its driver is set up for",
                  name, factor));
    return;
  }
  const DriverProtocol protocol = configuration::driver_of(hardware, joint).protocol;
  findings.push_back(formatted(
      "%s gives %.2f Nm per Nm asked: either write torque_factor = %.3f, as --out does, or %s; then repeat",
      name, factor, whole, vendors_setting(protocol, factor).c_str()));
  values.push_back({name, "torque_factor", configuration::number_text(std::round(1e3 * whole) / 1e3)});
}

Json estimate_json(const Estimate& estimate) {
  return {{"value", estimate.value}, {"half_width_95", estimate.half_width}};
}

}  // namespace

void judge(const IdentificationRequest& request, IdentificationReport& report) {
  std::vector<NewValue> factors;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const DriveNumbers& drive = report.drives[joint];
    const Estimate& factor = drive.torque_factor;
    if (!clear(drive)) {
      report.findings.push_back(
          formatted("%s: not clear, torque factor %.2f +- %.2f; look whether it moves freely and the gantry "
                    "holds the torso, then repeat",
                    kJointNames[joint], factor.value, factor.half_width));
    } else if (std::abs(factor.value - 1) > kRightFactor + factor.half_width) {
      judge_factor(request.hardware, joint, factor.value, report.findings, factors);
    }
  }
  if (!std::ranges::all_of(report.drives, clear)) return;
  compare_legs(report);
  compare_hips_and_knees(*request.robot, report);
  name_lacking_armatures(*request.robot, report);
  constexpr std::size_t kHip = 0, kKnee = 1;
  report.values = {
      {"robot", "hip_coulomb_friction_Nm", mean_text(report, kHip, &DriveNumbers::coulomb_friction_Nm)},
      {"robot", "knee_coulomb_friction_Nm", mean_text(report, kKnee, &DriveNumbers::coulomb_friction_Nm)},
      {"robot", "hip_damping_Nms_rad", mean_text(report, kHip, &DriveNumbers::damping_Nms_rad)},
      {"robot", "knee_damping_Nms_rad", mean_text(report, kKnee, &DriveNumbers::damping_Nms_rad)}};
  const std::string armature = armature_scale_text(*request.robot, report);
  if (!armature.empty()) report.values.push_back({"robot", "armature_scale", armature});
  report.values.insert(report.values.end(), factors.begin(), factors.end());
}

std::string to_text(const IdentificationReport& report) {
  std::string text =
      "joint   torque factor   armature kg m^2   damping Nm s/rad      friction Nm   residual Nm   peak Nm\n";
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const DriveNumbers& drive = report.drives[joint];
    text +=
        formatted("%-7s %5.3f +- %5.3f   %6.4f +- %6.4f   %6.3f +- %6.3f   %5.2f +- %5.2f  %12.3f  %8.1f\n",
                  kJointNames[joint], drive.torque_factor.value, drive.torque_factor.half_width,
                  drive.armature_kg_m2.value, drive.armature_kg_m2.half_width, drive.damping_Nms_rad.value,
                  drive.damping_Nms_rad.half_width, drive.coulomb_friction_Nm.value,
                  drive.coulomb_friction_Nm.half_width, drive.residual_Nm, report.peak_torque_Nm[joint]);
  }
  for (const std::string& finding : report.findings) text += finding + '\n';
  return text + values_text(report.values);
}

std::string to_json(const IdentificationReport& report, const std::string& file) {
  Json json;
  json["good"] = report.findings.empty();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const DriveNumbers& drive = report.drives[joint];
    json["joints"][kJointNames[joint]] = {{"torque_factor", estimate_json(drive.torque_factor)},
                                          {"armature_kg_m2", estimate_json(drive.armature_kg_m2)},
                                          {"damping_Nms_rad", estimate_json(drive.damping_Nms_rad)},
                                          {"coulomb_friction_Nm", estimate_json(drive.coulomb_friction_Nm)},
                                          {"torque_offset_Nm", estimate_json(drive.torque_offset_Nm)},
                                          {"residual_Nm", drive.residual_Nm},
                                          {"samples", drive.samples},
                                          {"peak_torque_Nm", report.peak_torque_Nm[joint]}};
  }
  json["findings"] = report.findings;
  json["values"] = values_json(report.values);
  json["written"] = file.empty() ? Json(nullptr) : Json(file);
  return json_text(json);
}

}  // namespace stilt::commissioning
