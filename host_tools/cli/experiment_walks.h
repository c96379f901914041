#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_tools/cli/controller_choice.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::cli {

/// Settings common to all walks of an experiment. The sensors have noise, so that seeds differ; with a
/// factor of 1: joints 0.5 mrad and 20 mrad/s, base 1 mrad and 10 mrad/s. plant_settings may change it.
struct WalkSetting {
  ControllerChoice choice;  ///< each case sets controller and horizon
  std::vector<std::string> plant_settings;
  std::string push_point = "hip";
  std::string state = "estimated";  ///< state that the controller gets: estimated (from sensors) or truth
};

/// The setting without values that the controller does not use: gaits, for one that follows none.
[[nodiscard]] WalkSetting setting_for(const WalkSetting& setting, const std::string& controller);

/// Runs walks as `stilt sim` does. Throws
/// UsageError or std::invalid_argument for an invalid setting.
[[nodiscard]] experiments::WalkRunner walk_runner(const WalkSetting& setting);

/// The same for walks of several controllers.
[[nodiscard]] experiments::WalkRunner runner_for_each(const WalkSetting& setting);

/// The `stilt sim` command that repeats a walk of walk_runner(): the same figures, to the last bit.
[[nodiscard]] std::string sim_command(const WalkSetting& setting, const experiments::WalkCase& walk);

/// All data that the walks of a controller under the setting depend on besides the program: active
/// configuration, robot, plant, gaits.
[[nodiscard]] std::string dependencies_text(const WalkSetting& setting, const std::string& controller,
                                            double horizon_s);

/// The same for each of these controllers, by name, without the horizon.
[[nodiscard]] std::map<std::string, std::string> parts_of(const WalkSetting& setting,
                                                          const std::vector<std::string>& controllers);

/// The parameters of one controller under the setting, checked.
[[nodiscard]] control::ControllerParameters walk_parameters(const WalkSetting& setting,
                                                            const std::string& controller, double horizon_s);

/// Duration of a step of that controller's gait, both supports: places the phases of an experiment.
[[nodiscard]] double walk_step_time_s(const WalkSetting& setting, const std::string& controller,
                                      double horizon_s);

}  // namespace stilt::cli
