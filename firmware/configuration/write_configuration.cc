/// stilt_write_configuration FILE: rewrites a configuration with every key, keeping the values and the
/// comment at its top. For developers, after a change of the schema; creates the file from defaults when
/// there is none.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/diagnostics/output_file.h"

namespace {

constexpr const char* kDefaultHeading =
    "Configuration of the controller. SI units; a key that is left out takes its default.\n"
    "`--set section.key=value` changes a value for one run.";

/// The comment lines that a file starts with, without their marks.
std::string heading_of(const std::string& path) {
  std::ifstream stream(path);
  std::string heading;
  std::string line;
  while (std::getline(stream, line) && line.starts_with('#')) {
    if (!heading.empty()) heading += '\n';
    heading += line.substr(line.starts_with("# ") ? 2 : 1);
  }
  return heading;
}

int refuse(const std::string& sentence) {
  std::fprintf(stderr, "%s\n", sentence.c_str());
  return 2;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2 || *arguments[1] == '-')
    return refuse("usage: stilt_write_configuration FILE.toml");
  const std::string path = arguments[1];

  std::string toml;
  if (std::filesystem::exists(path)) {
    auto parameters = stilt::configuration::load_file(path);
    if (!parameters) return refuse(stilt::configuration::to_string(parameters.error()));
    std::string& robot = parameters->hardware.robot;
    robot = stilt::configuration::robot_in_file(path, robot);
    toml = stilt::configuration::to_toml(*parameters, heading_of(path));
  } else {
    toml = stilt::configuration::to_toml({}, kDefaultHeading);
  }

  const auto written = stilt::diagnostics::write_file(path, toml);
  if (written) return 0;
  return refuse(path + ": cannot be written (" + written.error() + "); name a file in a writable folder");
}
