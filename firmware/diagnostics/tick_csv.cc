#include "firmware/diagnostics/tick_csv.h"

#include <cerrno>
#include <charconv>
#include <concepts>
#include <cstring>
#include <fstream>
#include <string_view>

namespace stilt::diagnostics {
namespace {

using supervisor::FaultSet;

constexpr std::array<const char*, hal::kJoints> kJoints = {"hip_L", "knee_L", "hip_R", "knee_R"};
constexpr std::array<const char*, model::kStates> kStateNames = {
    "x_b_m",   "z_b_m",   "pitch_b_rad",   "hip_L_rad",   "knee_L_rad",   "hip_R_rad",   "knee_R_rad",
    "x_b_m_s", "z_b_m_s", "pitch_b_rad_s", "hip_L_rad_s", "knee_L_rad_s", "hip_R_rad_s", "knee_R_rad_s"};
constexpr std::array<const char*, 3> kActions = {"silent", "commands", "disable"};
constexpr std::array<const char*, 4> kDriverStates = {"unknown", "idle", "enabled", "fault"};

/// Writes either the names of the columns or the values of a record, so that both come from the same lines.
class Line {
 public:
  Line(std::ostream& out, bool names) : out_(out), names_(names) {}

  void add(std::string_view prefix, std::string_view name, std::string_view value) {
    if (!first_) out_ << ',';
    first_ = false;
    if (names_) {
      out_ << prefix << name;
    } else {
      out_ << value;
    }
  }
  void add(std::string_view prefix, std::string_view name, double value) { add_number(prefix, name, value); }
  void add(std::string_view prefix, std::string_view name, std::integral auto value) {
    add_number(prefix, name, value);
  }

 private:
  void add_number(std::string_view prefix, std::string_view name, auto value) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    add(prefix, name, std::string_view(text, static_cast<std::size_t>(end - text)));
  }

  std::ostream& out_;
  bool names_;
  bool first_ = true;
};

std::string names(FaultSet faults) {
  std::string text;
  for (const supervisor::FaultRow& fault : supervisor::kFaultTable) {
    if (!faults.has(fault.fault)) continue;
    if (!text.empty()) text += '+';
    text += fault.name;
  }
  return text;
}

void add_reading(Line& line, const std::string& joint, const hal::JointReading& reading) {
  line.add(joint, "_position_rad", reading.position_rad);
  line.add(joint, "_velocity_rad_s", reading.velocity_rad_s);
  line.add(joint, "_torque_Nm", reading.torque_Nm);
  line.add(joint, "_driver_temperature_C", reading.driver_temperature_C);
  line.add(joint, "_motor_temperature_C", reading.motor_temperature_C);
  line.add(joint, "_supply_V", reading.supply_V);
  line.add(joint, "_missed_replies", reading.missed);
  line.add(joint, "_repeated_replies", reading.frozen);
  line.add(joint, "_driver_state", kDriverStates[static_cast<std::size_t>(reading.state)]);
  line.add(joint, "_driver_fault", hal::name(reading.fault));
  line.add(joint, "_driver_fault_code", reading.fault_code);
}

void add_base(Line& line, const hal::BaseReading& base) {
  line.add("base", "_pitch_rad", base.pitch_rad);
  line.add("base", "_pitch_rate_rad_s", base.pitch_rate_rad_s);
  line.add("base", "_acceleration_x_m_s2", base.acceleration_x_m_s2);
  line.add("base", "_acceleration_z_m_s2", base.acceleration_z_m_s2);
  line.add("", "left_foot_force_N", base.left_foot_force_N);
  line.add("", "right_foot_force_N", base.right_foot_force_N);
  line.add("base", "_missed_replies", base.missed);
  line.add("base", "_repeated_replies", base.frozen);
}

void add_command(Line& line, const std::string& prefix, const hal::JointCommand& command) {
  line.add(prefix, "_position_rad", command.position_rad);
  line.add(prefix, "_velocity_rad_s", command.velocity_rad_s);
  line.add(prefix, "_torque_Nm", command.torque_Nm);
  line.add(prefix, "_kp_Nm_rad", command.kp_Nm_rad);
  line.add(prefix, "_kd_Nms_rad", command.kd_Nms_rad);
}

void add_all(Line& line, const control_loop::TickRecord& record, std::int64_t start_ns) {
  line.add("", "tick", record.tick);
  line.add("", "time_s", 1e-9 * static_cast<double>(record.time_ns - start_ns));
  line.add("", "state", supervisor::name(record.state));
  line.add("", "rung", supervisor::name(record.level));
  line.add("", "reaction", supervisor::name(record.reaction));
  line.add("", "action", kActions[static_cast<std::size_t>(record.action)]);
  line.add("", "faults", names(record.present));
  line.add("", "latched_faults", names(record.latched));
  line.add("", "ramp", record.ramp);
  line.add("", "plan_sequence", record.plan_sequence);
  line.add("", "plan_age_s", record.plan_age_s);
  line.add("", "wakeup_us", 1e-3 * static_cast<double>(record.wakeup_ns));
  line.add("", "execution_us", 1e-3 * static_cast<double>(record.execution_ns));
  line.add("", "bus_round_trip_us", 1e-3 * static_cast<double>(record.round_trip_ns));
  for (std::size_t i = 0; i < hal::kJoints; ++i) add_reading(line, kJoints[i], record.joints[i]);
  add_base(line, record.base);
  for (std::size_t i = 0; i < model::kStates; ++i) {
    line.add("estimated_", kStateNames[i], record.estimated_state[i]);
  }
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    add_command(line, std::string("wanted_") + kJoints[i], record.wanted[i]);
  }
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    add_command(line, std::string("sent_") + kJoints[i], record.sent[i]);
  }
}

}  // namespace

void write_tick_header(std::ostream& out) {
  Line line(out, true);
  add_all(line, control_loop::TickRecord(), 0);
  out << '\n';
}

void write_tick(std::ostream& out, const control_loop::TickRecord& record, std::int64_t start_ns) {
  Line line(out, false);
  add_all(line, record, start_ns);
  out << '\n';
}

std::expected<void, std::string> write_csv(const std::string& path, const control_loop::TickBlackBox& box,
                                           std::int64_t start_ns) {
  errno = 0;
  std::ofstream out(path);
  if (out) write_tick_header(out);
  for (std::size_t i = 0; out && i < box.size(); ++i) write_tick(out, box.record(i), start_ns);
  out.close();
  if (!out) {
    return std::unexpected(path + ": the black box cannot be written there" +
                           (errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : ""));
  }
  return {};
}

}  // namespace stilt::diagnostics
