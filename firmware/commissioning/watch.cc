#include "firmware/commissioning/watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/commissioning/json_number.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/event_text.h"

namespace stilt::commissioning {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kSamplePeriod_ns = 100'000'000;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A column of 9 characters, "-" for what is not reported. A number that is too long has fewer decimals.
std::string column(double value, int decimals) {
  constexpr int kDigits = 8;
  char digits[kDigits + 2];
  int length = std::snprintf(digits, sizeof digits, "%.*f", decimals, value);
  for (; length > kDigits && decimals > 0; --decimals) {
    length = std::snprintf(digits, sizeof digits, "%.*f", decimals - 1, value);
  }
  if (length > kDigits) std::snprintf(digits, sizeof digits, "%.1e", value);
  char padded[16];
  std::snprintf(padded, sizeof padded, "%9s", std::isfinite(value) ? digits : "-");
  return padded;
}

bool silent(const hal::JointReading& joint) { return joint.missed_replies > kSilentReads; }

/// At most 80 characters, the state included.
std::string joint_line(const char* name, const hal::JointReading& joint) {
  char head[16];
  std::snprintf(head, sizeof head, "%-8s", name);
  return head + column(joint.position_rad, 3) + column(joint.position_rad * kDegrees, 1) +
         column(joint.velocity_rad_s, 2) + column(joint.torque_Nm, 1) +
         column(joint.driver_temperature_C, 0) + column(joint.motor_temperature_C, 0) +
         column(joint.supply_V, 1) + "  " +
         (silent(joint) ? "SILENT" : diagnostics::state_text(joint.state)) + '\n';
}

/// A line of its own, since it has no room beside a joint: the first fault, and how many more there are.
std::string fault_line(const hal::RobotReadings& readings) {
  std::string first;
  int more = -1;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::JointReading& reading = readings.joints[joint];
    if (reading.fault == hal::DriverFault::none) continue;
    if (++more > 0) continue;
    first = std::string(control_loop::kJointNames[joint]) + ' ' +
            diagnostics::fault_text(reading.fault, reading.fault_code);
  }
  return "driver faults   " + (first.empty() ? "none" : first) +
         (more > 0 ? ", " + std::to_string(more) + " more\n" : "\n");
}

Json joint_json(const hal::JointReading& joint) {
  return {{"position_rad", json_number(joint.position_rad)},
          {"velocity_rad_s", json_number(joint.velocity_rad_s)},
          {"torque_Nm", json_number(joint.torque_Nm)},
          {"driver_temperature_C", json_number(joint.driver_temperature_C)},
          {"motor_temperature_C", json_number(joint.motor_temperature_C)},
          {"supply_V", json_number(joint.supply_V)},
          {"mode", silent(joint) ? "silent" : diagnostics::state_text(joint.state)},
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

bool good(const WatchSample& sample) {
  const hal::RobotReadings& readings = sample.readings;
  const bool joints = std::ranges::all_of(readings.joints, [](const hal::JointReading& joint) {
    return !silent(joint) && joint.fault == hal::DriverFault::none && joint.state != hal::DriverState::idle;
  });
  return joints && readings.base.missed_replies <= kSilentReads &&
         (readings.emergency_stop == hal::EmergencyStopState::released ||
          readings.emergency_stop == hal::EmergencyStopState::absent);
}

std::string to_table(const WatchSample& sample) {
  const hal::RobotReadings& readings = sample.readings;
  std::string table = "joint         rad      deg    rad/s       Nm driver C  motor C supply V\n";
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    table += joint_line(control_loop::kJointNames[joint], readings.joints[joint]);
  }
  table += "torso   " + column(readings.base.pitch_rad, 3) + column(readings.base.pitch_rad * kDegrees, 1) +
           column(readings.base.pitch_rate_rad_s, 2) +
           (readings.base.missed_replies > kSilentReads ? "  SILENT\n" : "\n");
  table += fault_line(readings);
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
  return json_text(json, kOneLine);
}

}  // namespace stilt::commissioning
