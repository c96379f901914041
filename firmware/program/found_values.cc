#include "firmware/program/found_values.h"

#include <filesystem>
#include <system_error>
#include <vector>

#include "firmware/configuration/schema.h"
#include "firmware/diagnostics/input_file.h"
#include "firmware/diagnostics/output_file.h"
#include "firmware/robots/robots.h"

namespace stilt::program {
namespace {

using Text = std::expected<std::string, std::string>;

/// The error is one sentence for the user.
Text content(const std::string& file) {
  auto text = diagnostics::read_file(file);
  if (!text) return std::unexpected("--out: " + file + " cannot be read (" + text.error() + ")");
  return text;
}

/// The text that the configuration was read from; empty where it was the defaults.
Text text_read(const Options& options) {
  if (!options.config_file.empty()) return content(options.config_file);
  const std::string& robot = options.configuration.hardware.robot;
  if (robots::is_file(robot)) {
    const std::string beside = configuration::file_beside(robot);
    return std::filesystem::exists(beside) ? content(beside) : Text("");
  }
  for (const configuration::ShippedConfiguration& shipped : configuration::shipped_configurations()) {
    if (shipped.robot == robot) return std::string(shipped.text);
  }
  return "";
}

/// A device such as /dev/stdout holds no configuration.
bool is_there(const std::string& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

/// What the command line has set, as the run had it.
std::vector<configuration::NewValue> command_line_values(const Options& options) {
  std::vector<configuration::NewValue> values;
  for (const std::string& name : options.changed_keys) {
    const std::size_t dot = name.find('.');
    const configuration::Entry* entry = configuration::find_entry(name.substr(0, dot), name.substr(dot + 1));
    if (entry == nullptr) continue;
    values.push_back({std::string(entry->section), std::string(entry->key),
                      configuration::value_text(*entry, options.configuration)});
  }
  return values;
}

}  // namespace

std::expected<void, std::string> check_out_file(const Options& options) {
  const std::string& file = options.out_file;
  if (!is_there(file)) return {};
  const Text text = content(file);
  if (!text) return std::unexpected(text.error());
  if (const auto valid = configuration::parse(*text, file); !valid) {
    return std::unexpected("--out: what was found could not be written to this configuration:\n" +
                           configuration::to_string(valid.error()));
  }
  return {};
}

std::expected<void, std::string> write_values(const Options& options,
                                              std::span<const configuration::NewValue> values) {
  const std::string& file = options.out_file;
  std::vector<configuration::NewValue> all = command_line_values(options);
  all.insert(all.end(), values.begin(), values.end());
  const bool changes = is_there(file);
  if (!changes) all.push_back({"hardware", "robot", '"' + options.configuration.hardware.robot + '"'});
  const Text before = changes ? content(file) : text_read(options);
  if (!before) return std::unexpected(before.error());
  const auto text = configuration::with_values(*before, file, all);
  if (!text) return std::unexpected("--out " + configuration::to_string(text.error()));
  if (const auto valid = configuration::parse(*text, file); !valid) {
    return std::unexpected("--out: what was found makes no valid configuration, and nothing is written:\n" +
                           configuration::to_string(valid.error()));
  }
  const auto written = diagnostics::write_file(file, *text);
  if (!written) return std::unexpected("--out " + file + ": cannot be written (" + written.error() + ")");
  return {};
}

std::string written_text(const Options& options) {
  std::string text = "written to " + options.out_file;
  for (const std::string& name : options.changed_keys) {
    text += (&name == &options.changed_keys.front() ? ", with what the command line sets: " : ", ") + name;
  }
  return text + '\n';
}

}  // namespace stilt::program
