#include "firmware/commissioning/session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/commissioning/formatted.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/event_text.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::commissioning {
namespace {

constexpr std::int64_t kLongestBringUp_ns = 5'000'000'000;

bool gives_torque(const hal::JointCommand& command) {
  return command.torque_Nm != 0 || command.kp_Nm_rad != 0 || command.kd_Nms_rad != 0;
}

}  // namespace

hal::JointValues joint_angles(const hal::RobotReadings& readings) {
  hal::JointValues all_rad;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    all_rad[joint] = readings.joints[joint].position_rad;
  }
  return all_rad;
}

std::int64_t Session::begin_tick() {
  const std::int64_t before_ns = began_ns_;
  began_ns_ = clock_.sleep_until(pace_.next_ns());
  stall_ns_ = gives_torque_ ? began_ns_ - before_ns : 0;
  robot_.read(began_ns_, readings_);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (is_up_ && readings_.joints[joint].state == hal::DriverState::idle) fell_idle_[joint] = true;
  }
  return began_ns_;
}

void Session::command(const hal::JointCommands& commands) {
  gives_torque_ = std::ranges::any_of(commands, gives_torque);
  static_cast<void>(robot_.write(commands));  // a frame that did not leave shows as a missed reply
}

void Session::tick(const hal::JointCommands& commands) {
  begin_tick();
  command(commands);
  end_tick();
}

void Session::disable() {
  is_up_ = false;
  for (int tick = 0; tick < kLastTicks; ++tick) {
    begin_tick();
    static_cast<void>(robot_.disable());
    end_tick();
  }
}

std::string Session::bus_trouble() const {
  for (unsigned bus = 0; bus < hal::kMaximumBuses; ++bus) {
    const auto is = [bus](std::uint8_t buses) { return (buses >> bus & 1U) != 0; };
    if (is(readings_.buses.gone)) {
      return formatted("bus %u of hardware.buses is gone: look at its adapter, and whether it is up", bus);
    }
    if (is(readings_.buses.off)) {
      return formatted(
          "bus %u of hardware.buses is off, after too many errors: look at its cable, termination and bit "
          "rate, then take it down and up",
          bus);
    }
  }
  return "";
}

std::string Session::trouble() const {
  if (stopped()) return "stopped";
  if (const std::string found = bus_trouble(); !found.empty()) return found;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (const std::string found = driver_trouble(joint); !found.empty()) return found;
  }
  return "";
}

std::string Session::driver_trouble(std::size_t joint) const {
  const hal::JointReading& reading = readings_.joints[joint];
  const std::string driver = std::string("driver of ") + control_loop::kJointNames[joint];
  if (reading.fault != hal::DriverFault::none) {
    return driver + ": " + diagnostics::fault_text(reading.fault, reading.fault_code);
  }
  if (!std::isfinite(reading.position_rad)) return driver + " is silent";
  if (reading.missed_replies > kSilentReads) {
    const bool reports = began_ns_ - reading.time_ns <= kSilentReads * tick_ns_;
    return reports ? "no command leaves for the " + driver + ": look at the adapter of its bus"
                   : driver + " is silent";
  }
  if (robot_.void_offset() == joint) {
    return driver +
           " was silent or has started again, and counts from power-up: its zero is lost; begin anew";
  }
  return fell_idle_[joint] ? driver + " was disabled or has restarted: begin anew" : "";
}

std::string Session::torso_trouble() const {
  if (!std::isfinite(readings_.base.pitch_rad)) return "the torso sensor gives no pitch";
  return readings_.base.missed_replies > kSilentReads ? "the torso sensor is silent" : "";
}

std::string Session::limit_trouble() const {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::JointReading& reading = readings_.joints[joint];
    const double hotter_C = std::fmax(reading.driver_temperature_C, reading.motor_temperature_C);
    char text[160] = "";
    if (hotter_C >= limits_.overheated_C) {
      std::snprintf(text, sizeof text, "%s is at %.0f C, and supervisor.overheated_C is %g",
                    control_loop::kJointNames[joint], hotter_C, limits_.overheated_C);
    } else if (reading.supply_V < limits_.low_voltage_V || reading.supply_V > limits_.high_voltage_V) {
      std::snprintf(text, sizeof text,
                    "supply of %s is %.1f V, and supervisor.low_voltage_V to high_voltage_V are %g to %g",
                    control_loop::kJointNames[joint], reading.supply_V, limits_.low_voltage_V,
                    limits_.high_voltage_V);
    }
    if (text[0] != '\0') return text;
  }
  return "";
}

std::string Session::stall_trouble() const {
  const double stall_s = 1e-9 * static_cast<double>(stall_ns_);
  if (stall_s <= limits_.stall_s) return "";
  return formatted(
      "the loop stood still for %.3f s while a joint had torque, and supervisor.torque_loop_stall_s is %g: "
      "give it priority and a processor of its own (docs/deployment.md)",
      stall_s, limits_.stall_s);
}

std::string Session::trouble_with_torque() const {
  if (stopped()) return "stopped";
  if (const std::string found = bus_trouble(); !found.empty()) return found;  // it may carry the stop
  if (readings_.emergency_stop == hal::EmergencyStopState::pressed) return "emergency stop";
  if (readings_.emergency_stop == hal::EmergencyStopState::unknown) return "emergency stop is silent";
  for (const std::string& found : {stall_trouble(), trouble()}) {
    if (!found.empty()) return found;
  }
  return limit_trouble();
}

std::expected<void, std::string> Session::bring_up() {
  is_up_ = false;
  fell_idle_.fill(false);
  robot_.begin_bring_up();
  hal::BringUpProgress progress;
  for (std::int64_t left_ns = kLongestBringUp_ns; left_ns > 0 && !stopped(); left_ns -= tick_ns_) {
    progress = robot_.bring_up(begin_tick());
    end_tick();
    is_up_ = progress.ready;
    if (progress.ready) return {};
    if (progress.failed) break;
  }
  if (stopped()) return std::unexpected("stopped before the drivers were up");
  const std::string of_bus = bus_trouble();
  return std::unexpected(of_bus.empty() ? "the " + diagnostics::bring_up_text(progress) : of_bus);
}

}  // namespace stilt::commissioning
