#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "firmware/configuration/gaits/gait_record.h"

/// Gait files: one human-readable TOML file a gait (docs/gaits.md describes it). For start-up and host
/// programs: allocates, reads files; not for real time.
namespace stilt::gait_files {

/// Reads a gait from text; `file` names it in errors, and a relative URDF is found from its folder. The error
/// is one sentence: what, where, what would be right. A file may hold outputs alone: then gait.motion.degree
/// is 0 and speed, step time and step length are 0 unless given.
[[nodiscard]] std::expected<GaitRecord, std::string> parse_gait(std::string_view toml, std::string_view file);

/// Reads a gait file.
[[nodiscard]] std::expected<GaitRecord, std::string> load_gait(const std::string& path);

/// The record as text that parse_gait() reads back bit for bit. Needs a known motion.
/// For a file the robot must be as configuration::robot_in_file() names it.
[[nodiscard]] std::string to_toml(const GaitRecord& record);

}  // namespace stilt::gait_files
