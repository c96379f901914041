#include "firmware/library/read_settings.h"

#include <string_view>
#include <utility>
#include <vector>

#include "firmware/configuration/gaits/load_around_gaits.h"
#include "firmware/configuration/reach.h"
#include "firmware/robots/robots.h"

namespace stilt::library {

std::expected<configuration::Configuration, std::string> read_settings(const Settings& settings) {
  std::vector<configuration::Override> changes;
  for (const std::string& text : settings.settings) changes.push_back({text, "Settings::settings"});
  auto read = gait_files::load_around_gaits(settings.configuration_file, settings.robot, changes);
  if (!read) return std::unexpected(with_library_names(read.error()));
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

std::string with_library_names(std::string error) {
  constexpr std::pair<std::string_view, const char*> kNames[] = {{"--robot: ", "Settings::robot: "},
                                                                 {"--plant ", "plant: "}};
  for (const auto& [option, name] : kNames) {
    if (error.starts_with(option)) return error.replace(0, option.size(), name);
  }
  return error;
}

}  // namespace stilt::library
