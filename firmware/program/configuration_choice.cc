#include "firmware/program/configuration_choice.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "firmware/configuration/diagnostic.h"
#include "firmware/configuration/edit.h"
#include "firmware/configuration/gaits/load_around_gaits.h"
#include "firmware/robots/robots.h"

namespace stilt::program {
namespace {

std::vector<configuration::Override> overrides_of(const ConfigurationChoice& choice) {
  std::vector<configuration::Override> overrides;
  for (const std::string& setting : choice.settings) overrides.push_back({setting});
  std::string buses;
  for (const std::string& bus : choice.buses) buses += (buses.empty() ? "" : ",") + bus;
  if (!buses.empty()) overrides.push_back({"hardware.buses=" + buses, "--bus"});
  return overrides;
}

/// Whether a file that was read as TOML holds more than comments.
bool names_a_key(const std::string& file) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.substr(0, line.find('#')).find('=') != std::string::npos) return true;
  }
  return false;
}

/// The file, or the shipped configuration, that is read.
std::string origin_of(const ConfigurationChoice& choice) {
  if (!choice.file.empty()) return choice.file;
  const std::string robot = choice.robot.empty() ? std::string(configuration::kDefaultRobot) : choice.robot;
  if (!robots::is_file(robot)) return "the shipped configuration of " + robot;
  const std::string beside = configuration::file_beside(robot);
  return std::filesystem::exists(beside) ? beside : "the default configuration of " + robot;
}

/// What the configuration is read from, and what changes it then.
std::string source_of(const ConfigurationChoice& choice) {
  std::string source = origin_of(choice);
  if (!choice.file.empty() && !names_a_key(choice.file))
    source += " (names no key: every value is the default)";
  if (!choice.file.empty() && !choice.robot.empty()) source += ", --robot " + choice.robot;
  if (!choice.preset.empty()) source += ", preset " + choice.preset;
  for (const std::string& setting : choice.settings) source += ", --set " + setting;
  return source;
}

std::string name_of(const configuration::Override& change) {
  const std::string name = change.assignment.substr(0, change.assignment.find('='));
  const std::size_t first = name.find_first_not_of(" \t");
  return name.substr(first, name.find_last_not_of(" \t") - first + 1);
}

/// Of a command line that was accepted.
std::vector<std::string> changed_keys(const ConfigurationChoice& choice,
                                      const std::vector<configuration::Override>& overrides) {
  std::vector<std::string> names;
  for (const configuration::ShippedPreset& preset : configuration::shipped_presets()) {
    if (preset.name == choice.preset) names = configuration::keys_of(preset.text);
  }
  if (!choice.file.empty() && !choice.robot.empty()) names.emplace_back("hardware.robot");
  for (const configuration::Override& change : overrides) names.push_back(name_of(change));
  std::ranges::sort(names);
  const auto twice = std::ranges::unique(names);
  names.erase(twice.begin(), twice.end());
  return names;
}

}  // namespace

void add_configuration_options(CLI::App& app, ConfigurationChoice& choice) {
  app.add_option("--config", choice.file, "configuration (TOML)");
  app.add_option("--robot", choice.robot,
                 "robot: " + robots::shipped_names() +
                     ", or a URDF file; default: that of --config. Without --config its own configuration is "
                     "taken: the shipped one, or the TOML of the same stem beside the URDF")
      ->default_str(std::string(configuration::kDefaultRobot));
  app.add_option("--preset", choice.preset,
                 "shipped changes to the configuration, before --set: " + configuration::preset_names());
  app.add_option("--set", choice.settings,
                 "changes one key of the configuration: section.key=value; repeatable")
      ->allow_extra_args(false);
  app.add_option("--bus", choice.buses,
                 "a bus, in the order of their numbers, instead of hardware.buses: can0, fdcanusb:PATH, "
                 "loopback:NAME; "
                 "repeatable")
      ->allow_extra_args(false);
}

std::expected<ChosenConfiguration, std::string> read_configuration(const ConfigurationChoice& choice) {
  const auto overrides = overrides_of(choice);
  const auto read = gait_files::load_around_gaits(choice.file, choice.robot, overrides, choice.preset);
  if (!read) return std::unexpected(read.error());
  return ChosenConfiguration{*read, source_of(choice), changed_keys(choice, overrides)};
}

std::expected<ChosenConfiguration, std::string> written_configuration(const ConfigurationChoice& choice) {
  const auto overrides = overrides_of(choice);
  const auto read = configuration::load(choice.file, choice.robot, overrides, choice.preset);
  if (!read) return std::unexpected(configuration::to_string(read.error()));
  return ChosenConfiguration{*read, source_of(choice), changed_keys(choice, overrides)};
}

}  // namespace stilt::program
