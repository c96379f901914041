#include "firmware/commissioning/watch.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/commissioning/json_number.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/event_text.h"

namespace stilt::commissioning {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kSamplePeriod_ns = 100'000'000;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A column of 9 characters, "-" for what is not reported.
std::string column(double value, const char* format) {
  char digits[40];
  std::snprintf(digits, sizeof digits, format, value);
  char padded[48];
  std::snprintf(padded, sizeof padded, "%9s", std::isfinite(value) ? digits : "-");
  return padded;
}

std::string joint_line(const char* name, const hal::JointReading& joint) {
  char head[16];
  std::snprintf(head, sizeof head, "%-8s", name);
  std::string line = head + column(joint.position_rad, "%.3f") +
                     column(joint.position_rad * kDegrees, "%.1f") + column(joint.velocity_rad_s, "%.2f") +
                     column(joint.torque_Nm, "%.1f") + column(joint.driver_temperature_C, "%.0f") +
                     column(joint.motor_temperature_C, "%.0f") + column(joint.supply_V, "%.1f") + "  " +
                     diagnostics::state_text(joint.state);
  if (joint.fault != hal::DriverFault::none) {
    line += ": " + diagnostics::fault_text(joint.fault, joint.fault_code);
  }
  return line + (joint.missed_replies > kSilentReads ? ", SILENT\n" : "\n");
}

Json joint_json(const hal::JointReading& joint) {
  return {{"position_rad", json_number(joint.position_rad)},
          {"velocity_rad_s", json_number(joint.velocity_rad_s)},
          {"torque_Nm", json_number(joint.torque_Nm)},
          {"driver_temperature_C", json_number(joint.driver_temperature_C)},
          {"motor_temperature_C", json_number(joint.motor_temperature_C)},
          {"supply_V", json_number(joint.supply_V)},
          {"mode", diagnostics::state_text(joint.state)},
          {"fault", hal::name(joint.fault)},
          {"fault_code", joint.fault_code},
          {"missed_replies", joint.missed_replies}};
}

}  // namespace

std::expected<void, std::string> watch(Session& session, double duration_s,
                                       const std::function<void(const WatchSample&)>& show,
                                       const std::function<bool(const WatchSample&)>& follow) {
  if (const auto up = session.bring_up(); !up) {
    session.disable();
    return up;
  }
  const auto end_ns = static_cast<std::int64_t>(duration_s * 1e9);
  std::int64_t shown_ns = -kSamplePeriod_ns;
  bool goes_on = true;
  for (std::int64_t time_ns = 0; goes_on && !session.stopped() && (duration_s == 0.0 || time_ns < end_ns);
       time_ns += session.tick_ns()) {
    session.tick();
    const WatchSample sample{1e-9 * static_cast<double>(time_ns), session.readings()};
    goes_on = follow(sample);
    if (time_ns - shown_ns < kSamplePeriod_ns) continue;
    shown_ns = time_ns;
    show(sample);
  }
  session.disable();
  return {};
}

std::string to_table(const WatchSample& sample) {
  const hal::RobotReadings& readings = sample.readings;
  std::string table = "joint         rad      deg    rad/s       Nm driver C  motor C supply V\n";
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    table += joint_line(control_loop::kJointNames[joint], readings.joints[joint]);
  }
  table += "torso   " + column(readings.base.pitch_rad, "%.3f") +
           column(readings.base.pitch_rad * kDegrees, "%.1f") +
           column(readings.base.pitch_rate_rad_s, "%.2f") +
           (readings.base.missed_replies > kSilentReads ? "  SILENT\n" : "\n");
  table += std::string("emergency stop  ") + hal::name(readings.emergency_stop) + '\n';
  return table + "bus errors      " + std::to_string(readings.bus_errors) + '\n';
}

std::string to_json_line(const WatchSample& sample) {
  const hal::RobotReadings& readings = sample.readings;
  Json json;
  json["time_s"] = sample.time_s;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    json["joints"][control_loop::kJointNames[joint]] = joint_json(readings.joints[joint]);
  }
  json["torso"] = {{"pitch_rad", json_number(readings.base.pitch_rad)},
                   {"pitch_rate_rad_s", json_number(readings.base.pitch_rate_rad_s)},
                   {"missed_replies", readings.base.missed_replies}};
  json["emergency_stop"] = hal::name(readings.emergency_stop);
  json["bus_errors"] = readings.bus_errors;
  return json.dump() + "\n";
}

}  // namespace stilt::commissioning
