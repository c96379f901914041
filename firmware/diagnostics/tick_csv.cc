#include "firmware/diagnostics/tick_csv.h"

#include <charconv>
#include <concepts>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "firmware/control_loop/joint_names.h"
#include "firmware/control_loop/tick_fields.h"
#include "firmware/diagnostics/event_text.h"
#include "firmware/diagnostics/output_file.h"

namespace stilt::diagnostics {
namespace {

using control_loop::TickGroup;
using control_loop::TickRecord;
using supervisor::FaultSet;

constexpr std::array<const char*, model::kStates> kStateNames = {
    "x_b_m",   "z_b_m",   "pitch_b_rad",   "hip_L_rad",   "knee_L_rad",   "hip_R_rad",   "knee_R_rad",
    "x_b_m_s", "z_b_m_s", "pitch_b_rad_s", "hip_L_rad_s", "knee_L_rad_s", "hip_R_rad_s", "knee_R_rad_s"};
constexpr std::array<const char*, supervisor::kActions> kActions = {"silent", "commands", "disable"};

std::string text(std::integral auto number) { return std::to_string(number); }
std::string text(double number) {
  char digits[40];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}
std::string text(supervisor::State state) { return supervisor::name(state); }
std::string text(supervisor::FallbackLevel level) { return supervisor::name(level); }
std::string text(supervisor::Reaction reaction) { return supervisor::name(reaction); }
std::string text(supervisor::Action action) {
  const auto number = static_cast<std::size_t>(action);
  return number < kActions.size() ? kActions[number] : "unknown";
}
std::string text(hal::DriverState state) { return state_text(state); }
std::string text(hal::DriverFault fault) { return hal::name(fault); }
std::string text(FaultSet faults) {
  std::string names;
  for (const supervisor::FaultRow& fault : supervisor::kFaultTable) {
    if (!faults.has(fault.fault)) continue;
    if (!names.empty()) names += '+';
    names += fault.name;
  }
  return names;
}

/// Fields of these groups, in the order of the columns.
template <TickGroup... kGroups, class Visit>
void for_each_value_in(Visit&& visit) {
  (control_loop::for_each_value_of<kGroups>(visit), ...);
}

/// Calls visit(field, index) for every column after tick and time.
template <class Visit>
void for_each_column(Visit&& visit) {
  using enum TickGroup;
  for_each_value_in<decision, reaction, action, faults, ramp, plan, timing, joints, base, estimate, wanted,
                    sent>([&](const auto& field, std::size_t index) {
    if (!field.names.csv.empty()) visit(field, index);
  });
}

/// Name of a column, with that of the joint or of the component of the state in place of *.
std::string column_name(std::string_view name, std::size_t count, std::size_t index) {
  std::string text(name);
  if (const std::size_t star = text.find('*'); star != std::string::npos) {
    text.replace(star, 1, count == model::kStates ? kStateNames[index] : control_loop::kJointNames[index]);
  }
  return text;
}

/// A value in the unit of its column.
template <class Value>
std::string cell(const Value& value, double factor) {
  if constexpr (std::is_arithmetic_v<Value>) {
    if (factor != 1.0) return text(factor * static_cast<double>(value));
  }
  return text(value);
}

}  // namespace

void write_tick_header(std::ostream& out) {
  out << "tick,time_s";
  for_each_column([&](const auto& field, std::size_t index) {
    out << ',' << column_name(field.names.csv, field.count(), index);
  });
  out << '\n';
}

void write_tick(std::ostream& out, const TickRecord& record, std::int64_t start_ns) {
  out << record.tick << ',' << text(1e-9 * static_cast<double>(record.time_ns - start_ns));
  for_each_column([&](const auto& field, std::size_t index) {
    out << ',' << cell(field.at(record, index), control_loop::unit_factor(field.wire, field.names.csv));
  });
  out << '\n';
}

std::expected<void, std::string> write_csv(const std::string& path, const control_loop::TickBlackBox& box,
                                           std::int64_t start_ns) {
  std::ostringstream line;
  std::size_t lines = 0;
  const auto next = [&]() -> std::string_view {
    line.str("");
    if (lines == 0) write_tick_header(line);
    if (lines > 0 && lines <= box.size()) write_tick(line, box.record(lines - 1), start_ns);
    ++lines;
    return line.view();
  };
  constexpr bool kWait = false;
  const auto written = write_file(path, next, kWait);
  if (!written) {
    return std::unexpected(path + ": the black box cannot be written there (" + written.error() + ")");
  }
  return {};
}

}  // namespace stilt::diagnostics
