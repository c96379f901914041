#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/configuration/diagnostic.h"
#include "firmware/configuration/parameters.h"

/// The configuration of the controller: one commented TOML file per robot sets everything that is tunable.
///
/// A file holds sections of keys; the keys, their units, ranges and meaning are the table of schema.h. A key
/// that is left out takes the default named beside it in the shipped files. Unknown keys, wrong types, values
/// out of range and values that contradict each other are refused, all of them reported at once.
/// For start-up and host programs: allocates, reads files; not for real time.
namespace stilt::configuration {

/// The parameters, or everything that is wrong, in the order of the file, then of the preset, overrides last.
/// Contradictions between values are looked for once each value is valid by itself.
using Result = std::expected<Configuration, std::vector<Diagnostic>>;

/// A change made after the file is read, under the same checks. The last one of a key counts.
struct Override {
  std::string assignment;       ///< "section.key=value"; quotes around a word are optional
  std::string where = "--set";  ///< the option it came from, named in diagnostics
};

/// A configuration compiled into the program. Variants of a robot share their file.
struct ShippedConfiguration {
  std::string_view robot;  ///< name of the robot, such as "amber3m"
  std::string_view path;   ///< of the file it was made from, relative to the root of the project
  std::string_view text;   ///< that file
};

/// The shipped configurations, by name.
[[nodiscard]] std::span<const ShippedConfiguration> shipped_configurations();

/// A named set of changes compiled into the program: a configuration file with only the keys that it changes.
struct ShippedPreset {
  std::string_view name;
  std::string_view path;  ///< of the file it was made from, relative to the root of the project
  std::string_view text;  ///< that file
};

/// The shipped presets, by name.
[[nodiscard]] std::span<const ShippedPreset> shipped_presets();

/// Their names, separated by commas.
[[nodiscard]] std::string preset_names();

/// Reads a configuration from text, then the preset, then the overrides; a later value of a key counts.
/// Height and half width of the stance that none of them sets follow from the length of the legs of a URDF's
/// robot.
/// @param file    names the text in diagnostics; a relative URDF in it is found from this file's folder
/// @param preset  name of a shipped preset; empty: none
[[nodiscard]] Result parse(std::string_view toml, std::string_view file,
                           std::span<const Override> overrides = {}, std::string_view preset = {});

/// Reads a configuration file, as parse() does.
[[nodiscard]] Result load_file(const std::string& path, std::span<const Override> overrides = {},
                               std::string_view preset = {});

/// Plans keep supervisor.torque_limit_share, too, and a robot that may not step catches no fall by steps.
/// What runs a controller calls it after the last change; twice is as good as once.
void keep_torque_limit(Configuration& configuration);

/// The TOML of the same stem beside a URDF file.
[[nodiscard]] std::string file_beside(std::string_view urdf);

/// The files that a robot may be read from: a URDF file and file_beside() it. None for a shipped robot.
[[nodiscard]] std::vector<std::string> files_of_robot(std::string_view robot);

/// hardware.robot as a configuration file must name it. A relative URDF of a run is found from the working
/// directory. In the folder of the file it becomes its name alone, otherwise the whole path.
[[nodiscard]] std::string robot_in_file(std::string_view file, std::string_view robot);

/// The configuration of a robot, as parse() reads it. It is the shipped one, or for a URDF file the TOML of
/// the same stem beside it. Where there is none, the defaults.
[[nodiscard]] Result load_robot(std::string_view robot, std::span<const Override> overrides = {},
                                std::string_view preset = {});

/// The robot where neither a user nor a configuration names one.
inline constexpr std::string_view kDefaultRobot = "amber3m";

/// What a user chose: a file as load_file() reads it, or without one a robot as load_robot() does. A robot
/// beside a file takes the place of the one that the file names.
/// @param robot  empty: that of the file; without a file kDefaultRobot
[[nodiscard]] Result load(const std::string& file, std::string_view robot,
                          std::span<const Override> overrides, std::string_view preset = {});

/// The parameters as a TOML file that parse() reads back bit for bit. A comment above each key has meaning,
/// unit, range and default. `heading`: text of the first lines, put into comments.
[[nodiscard]] std::string to_toml(const Configuration& parameters, std::string_view heading);

}  // namespace stilt::configuration
