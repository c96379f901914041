#include "firmware/library/read_settings.h"

#include <vector>

#include "firmware/configuration/diagnostic.h"
#include "firmware/configuration/reach.h"
#include "firmware/robots/robots.h"

namespace stilt::library {

std::expected<configuration::Configuration, std::string> read_settings(const Settings& settings) {
  std::vector<configuration::Override> changes;
  const bool own_file = !settings.configuration_file.empty();
  if (own_file) changes.push_back({"hardware.robot=" + settings.robot, "Settings::robot"});
  for (const std::string& text : settings.settings) changes.push_back({text, "Settings::settings"});
  configuration::Result read = own_file ? configuration::load_file(settings.configuration_file, changes)
                                        : configuration::load_robot(settings.robot, changes);
  if (!read) return std::unexpected(configuration::to_string(read.error()));
  if (const auto robot = robots::find(read->hardware.robot)) {
    const auto poses = configuration::unreachable_poses(*read, (*robot)->model.constants);
    if (!poses.empty()) {
      return std::unexpected((own_file ? settings.configuration_file : settings.robot) + ": " +
                             poses.front());
    }
  }
  configuration::keep_torque_limit(*read);
  return std::move(*read);
}

}  // namespace stilt::library
