#include "firmware/program/report.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "firmware/configuration/hardware.h"
#include "firmware/configuration/hardware_consistency.h"
#include "firmware/configuration/reach.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/robots/robots.h"
#include "hal/robot/driver_settings.h"
#include "hal/robot/wiring_load.h"

namespace stilt::program {
namespace {

/// Of the straight leg; shipped robots stand at about 0.92. Lower, knees take much more torque; higher, legs
/// have no travel left.
constexpr double kLeastHeightShare = 0.8, kMostHeightShare = 0.97;

/// A sentence for each key of a driver that bring-up would refuse for its watchdog. Drivers of one kind have
/// the same.
std::vector<std::string> missing_watchdogs(const configuration::HardwareParameters& hardware) {
  constexpr std::size_t kKinds = 2;
  const hal::RobotWiring wiring = configuration::robot_wiring(hardware);
  std::vector<std::string> found;
  for (std::size_t joint = 0; joint < kKinds; ++joint) {
    const hal::bring_up::Options options = configuration::bring_up_options(hardware, joint, 0, 0);
    for (const hal::ReadSetting& key : hal::watchdog_keys(wiring.joints[joint].driver, options)) {
      if (key.right) continue;
      found.push_back(std::string(control_loop::driver_section(joint)) + '.' + key.name + " is " + key.is +
                      ", and must be " + key.wanted);
    }
  }
  return found;
}

}  // namespace

BusReport report_buses(const configuration::Configuration& configuration) {
  BusReport report;
  const std::vector<std::string> names = configuration::bus_names(configuration.hardware);
  for (std::size_t bus = 0; bus < names.size(); ++bus) {
    const hal::BusLoad load =
        configuration::bus_load(configuration.hardware, bus, configuration.timing.torque_rate_hz);
    report.text += hal::load_sentence(names[bus], load) + '\n';
    report.refused = report.refused || load.verdict == hal::BusLoadVerdict::refused;
  }
  for (const std::string& line : missing_watchdogs(configuration.hardware)) {
    report.text += line + '\n';
    report.refused = true;
  }
  const std::string exchangeable = configuration::exchangeable_buses(configuration.hardware);
  if (!exchangeable.empty()) report.text += exchangeable + '\n';
  if (const auto robot = robots::find(configuration.hardware.robot)) {
    for (const std::string& line : configuration::unreachable(configuration, (*robot)->model.constants)) {
      report.text += line + '\n';
      report.refused = true;
    }
  }
  return report;
}

std::string robot_text(const configuration::Configuration& configuration) {
  const auto robot = robots::find(configuration.hardware.robot);
  if (!robot) return robot.error() + '\n';
  const model::RobotConstants& constants = (*robot)->model.constants;
  const double* armature = constants.joint_parameters;
  const double height_m = configuration.reference.base_height_m;
  const double share = height_m / (constants.thigh_length_m + constants.shin_length_m);
  const bool usual = share >= kLeastHeightShare && share <= kMostHeightShare;
  char text[300];
  (void)std::snprintf(
      text, sizeof text,
      "mass %.4g kg, thigh %.4g m, shin %.4g m\n"
      "armature hip_L %.4g, knee_L %.4g, hip_R %.4g, knee_R %.4g kg m^2\n"
      "hip height %.4g m, %.0f %% of the straight leg%s\n",
      constants.total_mass_kg, constants.thigh_length_m, constants.shin_length_m, armature[0], armature[1],
      armature[2], armature[3], height_m, 100 * share,
      usual ? "" : ": 80 to 97 % are usual; reference.base_height_m may be that of another robot");
  return text;
}

bool requires_realtime(const configuration::Configuration& configuration) {
  const std::vector<std::string> names = configuration::bus_names(configuration.hardware);
  const bool simulated = std::ranges::all_of(names, [](const std::string& name) {
    return name.starts_with("loopback:") || name.starts_with("vcan");
  });
  const configuration::RuntimeParameters& runtime = configuration.runtime;
  return runtime.require_realtime_always || (runtime.require_realtime && !simulated);
}

realtime::Requirements requirements_of(const configuration::RuntimeParameters& runtime) {
  return {runtime.torque_priority, runtime.planner_priority, runtime.torque_core, runtime.planner_core,
          runtime.idle_exit_max_s};
}

std::string idle_text(const realtime::Capability& capability) {
  return capability.idle.held() ? "kept short" : "as they are (" + capability.idle.reason() + ")";
}

std::string describe(const realtime::Capability& capability) {
  std::string text = "kernel " + capability.kernel + ", " + std::to_string(capability.cores) +
                     (capability.cores == 1 ? " processor" : " processors");
  if (capability.torque_core >= 0) {
    text += ", processor " + std::to_string(capability.torque_core) +
            (capability.core_isolated ? " isolated" : " shared with other programs");
  }
  if (!capability.governor.empty()) text += ", governor " + capability.governor;
  text += capability.memory_locked ? ", memory locked" : ", memory not locked";
  text += capability.priority_allowed ? ", priority granted" : ", no priority";
  text += ", idle states " + idle_text(capability) + '\n';
  return text + (capability.realtime() ? "real time\n"
                                       : "not real time: " + realtime::lacking_text(capability) + '\n');
}

}  // namespace stilt::program
