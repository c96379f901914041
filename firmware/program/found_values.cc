#include "firmware/program/found_values.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <system_error>
#include <vector>

#include "firmware/configuration/schema.h"
#include "firmware/control_loop/joint_names.h"
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

/// hardware.robot as the file for the values names it.
std::string robot_text(const Options& options) {
  return '"' + configuration::robot_in_file(options.out_file, options.configuration.hardware.robot) + '"';
}

/// What the command line has set, as the run had it.
std::vector<configuration::NewValue> command_line_values(const Options& options) {
  std::vector<configuration::NewValue> values;
  for (const std::string& name : options.changed_keys) {
    const std::size_t dot = name.find('.');
    const configuration::Entry* entry = configuration::find_entry(name.substr(0, dot), name.substr(dot + 1));
    if (entry == nullptr) continue;
    values.push_back({std::string(entry->section), std::string(entry->key),
                      name == "hardware.robot" ? robot_text(options)
                                               : configuration::value_text(*entry, options.configuration)});
  }
  return values;
}

/// Whether values depend on this key when they are found. What calibrate writes for each joint does not
/// count.
bool is_wiring(const configuration::Entry& entry) {
  constexpr std::array<std::string_view, 8> kSections = {
      "hardware", "hip_driver", "knee_driver", "hip_L", "knee_L", "hip_R", "knee_R", "torso_sensor"};
  return std::ranges::find(kSections, entry.section) != kSections.end() && entry.key != "reversed" &&
         entry.key != "offset_rad";
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

/// A file beside a URDF is of that robot, also where it does not name it.
std::vector<configuration::Override> robot_of_file(const Options& options) {
  const std::string& robot = options.configuration.hardware.robot;
  if (!robots::is_file(robot) || !same_file(configuration::file_beside(robot), options.out_file)) return {};
  return {{"hardware.robot=" + robot}};
}

/// Values belong to the wiring that they are found with: the file's must be that of the run.
std::expected<void, std::string> check_wiring(const Options& options,
                                              const configuration::Configuration& there) {
  for (const configuration::Entry& entry : configuration::entries()) {
    if (!is_wiring(entry)) continue;
    const std::string own = configuration::value_text(entry, options.configuration);
    const std::string other = configuration::value_text(entry, there);
    if (own == other) continue;
    if (entry.name() == "hardware.robot" &&
        same_file(options.configuration.hardware.robot, there.hardware.robot)) {
      continue;
    }
    std::string sentence = "--out " + options.out_file + ": " + entry.name() + " is ";
    sentence.append(other).append(" there and ").append(own);
    sentence.append(" in this run, and what is found belongs to one wiring; take --config ");
    return std::unexpected(sentence.append(options.out_file).append(", or a new file for --out"));
  }
  return {};
}

/// The text of options.out_file with values and with what the command line has set. The error is for the
/// user.
Text text_with(const Options& options, std::span<const configuration::NewValue> values) {
  const std::string& file = options.out_file;
  std::vector<configuration::NewValue> all = command_line_values(options);
  all.insert(all.end(), values.begin(), values.end());
  const bool changes = is_there(file);
  if (!changes) all.push_back({"hardware", "robot", robot_text(options)});
  const Text before = changes ? content(file) : text_read(options);
  if (!before) return before;
  auto text = configuration::with_values(*before, file, all);
  if (!text) return std::unexpected("--out " + configuration::to_string(text.error()));
  if (const auto valid = configuration::parse(*text, file, robot_of_file(options)); !valid) {
    return std::unexpected("--out: what is found makes no valid configuration, and nothing is written:\n" +
                           configuration::to_string(valid.error()));
  }
  return *std::move(text);
}

/// The keys that a command may find, with the values of a configuration.
std::vector<configuration::NewValue> values_to_find(Task task,
                                                    const configuration::Configuration& configuration) {
  std::vector<configuration::NewValue> values;
  const auto add = [&](std::string_view section, std::initializer_list<std::string_view> keys) {
    for (const std::string_view key : keys) {
      const configuration::Entry* entry = configuration::find_entry(section, key);
      if (entry == nullptr) continue;
      values.push_back(
          {std::string(section), std::string(key), configuration::value_text(*entry, configuration)});
    }
  };
  for (const char* joint : control_loop::kJointNames) {
    if (task == Task::calibrate) add(joint, {"reversed", "offset_rad"});
    if (task == Task::identify) add(joint, {"torque_factor"});
  }
  if (task == Task::calibrate) {
    add("torso_sensor",
        {"encoder_reversed", "encoder_offset_rad", "imu_reversed", "imu_offset_rad", "pitch", "pitch_rate"});
  }
  if (task == Task::identify) {
    add("robot", {"hip_coulomb_friction_Nm", "knee_coulomb_friction_Nm", "hip_damping_Nms_rad",
                  "knee_damping_Nms_rad", "armature_scale"});
  }
  return values;
}

/// Whether what the command finds can be written, before a person moves joints for it.
std::expected<void, std::string> check_keys(const Options& options,
                                            const configuration::Configuration& there) {
  const Text text = text_with(options, values_to_find(options.task, there));
  if (!text) return std::unexpected(text.error());
  return {};
}

}  // namespace

std::expected<void, std::string> check_out_file(const Options& options) {
  const std::string& file = options.out_file;
  if (file.empty()) return {};
  if (!is_there(file)) return check_keys(options, options.configuration);
  const Text before = content(file);
  if (!before) return std::unexpected(before.error());
  const auto text = configuration::with_values(*before, file, command_line_values(options));
  const auto there = configuration::parse(text ? *text : *before, file, robot_of_file(options));
  if (!there) {
    return std::unexpected("--out: what is found cannot be written to this configuration:\n" +
                           configuration::to_string(there.error()));
  }
  if (const auto right = check_wiring(options, *there); !right) return right;
  return check_keys(options, *there);
}

std::expected<void, std::string> write_values(const Options& options,
                                              std::span<const configuration::NewValue> values) {
  const std::string& file = options.out_file;
  const Text text = text_with(options, values);
  if (!text) return std::unexpected(text.error());
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
