#include "firmware/program/found_values.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "firmware/diagnostics/output_file.h"
#include "firmware/robots/robots.h"

namespace stilt::program {
namespace {

std::string content(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The text that the configuration was read from; empty where it was the defaults.
std::string text_read(const Options& options) {
  if (!options.config_file.empty()) return content(options.config_file);
  const std::string& robot = options.configuration.hardware.robot;
  if (robots::is_file(robot)) return content(configuration::file_beside(robot));
  for (const configuration::ShippedConfiguration& shipped : configuration::shipped_configurations()) {
    if (shipped.robot == robot) return std::string(shipped.text);
  }
  return "";
}

}  // namespace

std::expected<void, std::string> write_values(const Options& options,
                                              std::span<const configuration::NewValue> values) {
  const std::string& file = options.out_file;
  std::vector<configuration::NewValue> all(values.begin(), values.end());
  const bool changes = std::filesystem::exists(file);
  if (!changes) all.push_back({"hardware", "robot", '"' + options.configuration.hardware.robot + '"'});
  const auto text = configuration::with_values(changes ? content(file) : text_read(options), file, all);
  if (!text) return std::unexpected("--out " + configuration::to_string(text.error()));
  if (const auto valid = configuration::parse(*text, file); !valid) {
    return std::unexpected("--out: what was found makes no valid configuration, and nothing is written:\n" +
                           configuration::to_string(valid.error()));
  }
  const auto written = diagnostics::write_file(file, *text);
  if (!written) return std::unexpected("--out " + file + ": cannot be written (" + written.error() + ")");
  return {};
}

}  // namespace stilt::program
