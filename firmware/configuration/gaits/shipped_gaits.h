#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "mpc_core/gait/gait_library.h"

namespace stilt::gait_files {

/// A gait file compiled into the program.
struct ShippedGait {
  std::string_view robot;  ///< name of the robot, such as "amber3m"
  std::string_view path;   ///< of the file it was made from, relative to the root of the project
  std::string_view text;   ///< that file
};

/// All shipped gaits, in no particular order.
[[nodiscard]] std::span<const ShippedGait> shipped_gaits();

/// Fills a library, slowest gait first: with the shipped gaits of a robot, or with all files *.toml of a
/// folder. The error is one sentence; the library is then empty. For start-up: allocates, reads files.
[[nodiscard]] std::expected<void, std::string> load_shipped_library(std::string_view robot,
                                                                    gait::GaitLibrary& library);
[[nodiscard]] std::expected<void, std::string> load_library(const std::string& folder, std::string_view robot,
                                                            gait::GaitLibrary& library);

}  // namespace stilt::gait_files
