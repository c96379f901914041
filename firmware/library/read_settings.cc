#include "firmware/library/read_settings.h"

#include <vector>

#include "firmware/configuration/gaits/load_around_gaits.h"
#include "firmware/configuration/reach.h"
#include "firmware/robots/robots.h"

namespace stilt::library {

std::expected<configuration::Configuration, std::string> read_settings(const Settings& settings) {
  std::vector<configuration::Override> changes;
  for (const std::string& text : settings.settings) changes.push_back({text, "Settings::settings"});
  auto read = gait_files::load_around_gaits(settings.configuration_file, settings.robot, changes);
  if (!read) return std::unexpected(read.error());
  if (const auto robot = robots::find(read->hardware.robot)) {
    const auto poses = configuration::unreachable_poses(*read, (*robot)->model.constants);
    if (!poses.empty()) {
      const std::string& file = settings.configuration_file;
      return std::unexpected((file.empty() ? read->hardware.robot : file) + ": " + poses.front());
    }
  }
  configuration::keep_torque_limit(*read);
  return std::move(*read);
}

}  // namespace stilt::library
