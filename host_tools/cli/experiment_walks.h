#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_tools/cli/controller_choice.h"
#include "host_tools/experiments/walk_case.h"

namespace stilt::cli {

/// What all walks of an experiment share. Sensors are noisy, so that seeds differ, unless a case has none:
/// joints 0.5 mrad and 20 mrad/s, base 1 mrad and 10 mrad/s; plant_settings may change that.
struct WalkSetting {
  ControllerChoice choice;  ///< controller and horizon are those of the case
  std::vector<std::string> plant_settings;
  std::string push_point = "hip";
  std::string state = "estimated";  ///< what the controller knows: estimated (from sensors) or truth
};

/// The setting without what does not concern a controller: gaits, for one that follows none.
[[nodiscard]] WalkSetting setting_for(const WalkSetting& setting, const std::string& controller);

/// Walks as `stilt sim` makes them, with 100 plans per second unless the choice says otherwise. Throws
/// UsageError or std::invalid_argument when the setting is mistaken.
[[nodiscard]] experiments::WalkRunner walk_runner(const WalkSetting& setting);

/// The same for walks of any controller.
[[nodiscard]] experiments::WalkRunner runner_for_each(const WalkSetting& setting);

/// Everything that a controller's walks under the setting depend on besides the program: configuration in
/// force, robot, plant, gaits.
[[nodiscard]] std::string dependencies_text(const WalkSetting& setting, const std::string& controller,
                                            double horizon_s);

/// The same of each of these controllers, by name, the horizon aside.
[[nodiscard]] std::map<std::string, std::string> parts_of(const WalkSetting& setting,
                                                          const std::vector<std::string>& controllers);

/// The parameters of one controller under the setting, checked.
[[nodiscard]] control::ControllerParameters walk_parameters(const WalkSetting& setting,
                                                            const std::string& controller, double horizon_s);

}  // namespace stilt::cli
