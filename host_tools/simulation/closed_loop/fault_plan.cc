#include "host_tools/simulation/closed_loop/fault_plan.h"

#include <array>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "firmware/control_loop/joint_names.h"
#include "hal/robot/robot_wiring.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {
namespace {

using control_loop::kJointNames;

constexpr double kForever_s = std::numeric_limits<double>::infinity();
constexpr std::size_t kDefaultJoint = 1;  // a knee: it carries the body

using enum FaultKind;
constexpr std::array kTable = {
    FaultDescription{drop, "drop", FaultTarget::frames, true, kForever_s, "frames are lost, both ways"},
    FaultDescription{delay, "delay", FaultTarget::frames, true, kForever_s,
                     "frames of the robot arrive 5 ms late"},
    FaultDescription{duplicate, "duplicate", FaultTarget::frames, true, kForever_s,
                     "frames of the robot arrive twice"},
    FaultDescription{corrupt, "corrupt", FaultTarget::frames, true, kForever_s,
                     "one bit of each frame of the robot is wrong"},
    FaultDescription{bus_off, "bus-off", FaultTarget::bus, true, kForever_s,
                     "the bus is off, with its error frame; with a duration it restarts by itself"},
    FaultDescription{disconnect, "disconnect", FaultTarget::bus, true, kForever_s,
                     "the bus is gone (loopback, not with --lockstep)"},
    FaultDescription{driver_fault, "driver-fault", FaultTarget::joint, false, kForever_s,
                     "the driver reports over-current and is disabled, until it is cleared"},
    FaultDescription{encoder_freeze, "encoder-freeze", FaultTarget::joint, false, kForever_s,
                     "the encoder goes on reporting its last value"},
    FaultDescription{torque_loss, "torque-loss", FaultTarget::joint, false, kForever_s,
                     "the driver answers as ever, and the motor gives no torque"},
    FaultDescription{power_cycle, "power-cycle", FaultTarget::drivers, false, 0.5,
                     "the drivers have no power, and start anew when it returns"},
    FaultDescription{low_voltage, "low-voltage", FaultTarget::drivers, false, kForever_s,
                     "the supply falls to 30 V: drivers that measure it report it, the others are disabled"},
    FaultDescription{over_temperature, "over-temperature", FaultTarget::drivers, false, kForever_s,
                     "transistors and motor report 120 degrees"},
    FaultDescription{emergency_stop, "emergency-stop", FaultTarget::robot, false, kForever_s,
                     "the switch reports that it is pressed (power stays, which a real switch would cut)"},
    FaultDescription{base_silent, "base-silent", FaultTarget::robot, false, kForever_s,
                     "the torso sensor sends nothing"},
    FaultDescription{base_freeze, "base-freeze", FaultTarget::robot, false, kForever_s,
                     "the torso sensor repeats its last values"},
};

std::invalid_argument bad(std::string_view whole, const std::string& problem) {
  return std::invalid_argument("--fault " + std::string(whole) + ": " + problem);
}

const FaultDescription& find(std::string_view whole, std::string_view name) {
  for (const FaultDescription& row : kTable) {
    if (name == row.name) return row;
  }
  std::string known;
  for (const FaultDescription& row : kTable) known += (known.empty() ? "" : ", ") + std::string(row.name);
  throw bad(whole, "no such fault; known are " + known);
}

void set_target(std::string_view whole, std::string_view target, FaultTarget allowed, TimedFault& fault) {
  for (std::size_t joint = 0; joint < kJointNames.size(); ++joint) {
    if (target == kJointNames[joint]) fault.joint = joint;
  }
  if (target.size() == 1 && target[0] >= '0' && target[0] < '0' + static_cast<int>(hal::kMaximumBuses)) {
    fault.bus = static_cast<std::size_t>(target[0] - '0');
  }
  const bool by_joint = fault.joint && allowed != FaultTarget::bus;
  const bool by_bus = fault.bus && allowed != FaultTarget::joint;
  if (allowed == FaultTarget::robot || (!by_joint && !by_bus)) {
    throw bad(whole, "'" + std::string(target) + "' is nothing this fault can affect; " +
                         (allowed == FaultTarget::robot ? "it takes no target"
                          : allowed == FaultTarget::bus ? "it takes the number of a bus, 0 to 3"
                          : allowed == FaultTarget::joint
                              ? "it takes a joint: hip_L, knee_L, hip_R, knee_R"
                              : "it takes a joint (hip_L, knee_L, hip_R, knee_R) or the number of a bus"));
  }
}

double time_of(std::string_view whole, std::string_view text) {
  const std::optional<double> value = parse_number(text);
  if (!value || *value < 0.0) {
    throw bad(whole, "expected NAME[:TARGET]@START[+DURATION] in seconds, for example bus-off:1@5+0.1");
  }
  return *value;
}

}  // namespace

std::span<const FaultDescription> fault_table() { return kTable; }

const FaultDescription& describe(FaultKind kind) { return kTable[static_cast<std::size_t>(kind)]; }

const char* joint_name(std::size_t joint) { return kJointNames[joint]; }

std::string describe_faults(FaultsOf which) {
  std::string text;
  for (const FaultDescription& row : kTable) {
    if (which == FaultsOf::plant && row.needs_bus) continue;
    char line[160];
    std::snprintf(line, sizeof line, "  %-17s %s\n", row.name, row.description);
    text += line;
  }
  return text;
}

TimedFault parse_fault(std::string_view text) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) time_of(text, "");
  std::string_view name = text.substr(0, at);
  const std::size_t colon = name.find(':');
  const FaultDescription& row = find(text, name.substr(0, colon));
  TimedFault fault{.kind = row.kind, .bus = {}, .joint = {}};
  if (colon != std::string_view::npos) {
    set_target(text, name.substr(colon + 1), row.target, fault);
  } else if (row.target == FaultTarget::joint) {
    fault.joint = kDefaultJoint;
  } else if (row.target == FaultTarget::bus) {
    fault.bus = 0;
  }
  const std::string_view times = text.substr(at + 1);
  const std::size_t plus = times.find('+');
  fault.start_s = time_of(text, times.substr(0, plus));
  fault.duration_s =
      plus == std::string_view::npos ? row.default_duration_s : time_of(text, times.substr(plus + 1));
  return fault;
}

}  // namespace stilt::simulation
