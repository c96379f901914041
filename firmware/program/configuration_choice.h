#pragma once

#include <CLI/App.hpp>
#include <expected>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"

namespace stilt::program {

/// The options of stiltd that choose and change the configuration.
struct ConfigurationChoice {
  std::string file;                   ///< of --config; empty: none
  std::string robot;                  ///< of --robot; empty: that of the file
  std::string preset;                 ///< of --preset; empty: none
  std::vector<std::string> settings;  ///< of --set
  std::vector<std::string> buses;     ///< of --bus
};

/// What was chosen.
struct ChosenConfiguration {
  configuration::Configuration configuration;
  std::string source;  ///< the file, or the shipped one, that it was read from; what changed it
  std::vector<std::string> changed_keys;  ///< "section.key" that --preset, --set and --bus have set
};

/// Adds these options to a command line.
void add_configuration_options(CLI::App& app, ConfigurationChoice& choice);

/// Reads the configuration, with what plans around gaits take from these. The error is for the user: a
/// sentence, or a line for each mistake.
[[nodiscard]] std::expected<ChosenConfiguration, std::string> read_configuration(
    const ConfigurationChoice& choice);

/// The same as it is written: nothing in it follows from anything else. For files.
[[nodiscard]] std::expected<ChosenConfiguration, std::string> written_configuration(
    const ConfigurationChoice& choice);

}  // namespace stilt::program
