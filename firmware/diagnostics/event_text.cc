#include "firmware/diagnostics/event_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/control_loop/joint_names.h"
#include "hal/driver/scanned_driver.h"

namespace stilt::diagnostics {
namespace {

std::string with_unit(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.4g %s", value, unit);
  return text;
}

/// Such as "knee_L is at 1.2 rad, must be within 0.4 rad and 0.8 rad".
std::string miss_text(const control_loop::PoseMiss& miss) {
  using control_loop::PoseMiss;
  if (miss.none()) return "it is in the pose";
  const auto joint = static_cast<std::size_t>(miss.joint);
  const std::string is = std::isfinite(miss.value) ? with_unit(miss.value, miss.unit) : "not a number";
  return std::string(miss.joint == PoseMiss::kTorso ? "the torso" : control_loop::kJointNames[joint]) +
         " is at " + is + ", must be within " + with_unit(miss.lowest, miss.unit) + " and " +
         with_unit(miss.highest, miss.unit);
}

}  // namespace

std::string pose_text(const control_loop::Event& event) {
  const std::string miss = miss_text(event.pose);
  switch (event.kind) {
    case control_loop::Event::Kind::waits_for_pose:
      return "not in a pose to stand up from: " + miss + "; waits until somebody puts it there";
    case control_loop::Event::Kind::lost_stance:
      return "left the standing pose while it stood up: " + miss + "; damped; put it there and ask again";
    case control_loop::Event::Kind::stopped_waiting:
      return "waits no longer for the standing pose: " + miss + "; put it there and ask again";
    default:
      return {};
  }
}

const char* state_text(hal::DriverState state) {
  constexpr std::array<const char*, hal::kDriverStates> kNames = {"unknown", "idle", "enabled", "fault"};
  const auto number = static_cast<std::size_t>(state);
  return number < kNames.size() ? kNames[number] : "unknown";
}

std::string fault_text(hal::DriverFault fault, std::uint32_t code) {
  return std::string(hal::name(fault)) + ", vendor code " + std::to_string(code);
}

std::string over_text(supervisor::Fault fault) {
  return supervisor::row(fault).severity == supervisor::Severity::latched ? ": over, and waits for a reset"
                                                                          : ": over";
}

std::string found_words(const supervisor::FaultDetail& found) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (found.joint >= 0) add(control_loop::kJointNames[static_cast<std::size_t>(found.joint)]);
  if (found.driver_fault != hal::DriverFault::none) {
    add(fault_text(found.driver_fault, found.fault_code));
  }
  if (found.bus >= 0) add("bus " + std::to_string(found.bus) + " of hardware.buses");
  if (*found.condition != '\0') add(found.condition);
  if (!std::isnan(found.limit)) {
    add(std::isnan(found.value) ? "not a number" : with_unit(found.value, found.unit));
    add("limit " + with_unit(found.limit, found.unit));
  }
  return text;
}

std::string found_text(const supervisor::FaultDetail& found) {
  const std::string words = found_words(found);
  return words.empty() ? words : ": " + words;
}

std::string bring_up_text(const hal::BringUpProgress& progress) {
  std::string text = std::string("driver of ") + control_loop::kJointNames[progress.joint] +
                     " cannot be brought up: " + hal::bring_up::name(progress.failure);
  if (progress.fault != hal::DriverFault::none) {
    text += " (" + fault_text(progress.fault, progress.fault_code) + ")";
  }
  if (progress.failure == hal::bring_up::Failure::slow_reply) {
    text += ": after " + with_unit(1e3 * progress.reply_lag_s, "ms") + ", see hardware.longest_reply_lag_s";
  }
  if (progress.failure == hal::bring_up::Failure::void_offsets) {
    text +=
        ": it was silent or has started again, so its power or its cable was lost, and it counts from "
        "power-up; end stiltd, let the legs hang, and start it anew after `stiltd selftest --hanging` or "
        "`stiltd calibrate`";
  }
  if (progress.failure == hal::bring_up::Failure::wrong_version) {
    text += ": " + hal::dotted_bytes(progress.version) + " instead of " +
            hal::dotted_bytes(progress.wanted_version);
  }
  if (progress.setting != hal::bring_up::Setting::none) {
    text += "; ";
    if (hal::bring_up::is_key(progress.setting))
      text += std::string("in ") + control_loop::driver_section(progress.joint) + ", ";
    text += hal::bring_up::name(progress.setting);
  }
  return text;
}

}  // namespace stilt::diagnostics
