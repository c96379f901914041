#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/configuration/diagnostic.h"

namespace stilt::configuration {

/// A configuration file under the names of this release, and what was renamed in it.
struct Migration {
  std::string text;                 ///< the file; comments, order and values as before
  std::vector<Diagnostic> changes;  ///< one for each renamed key or section, with its place in the old file
};

/// Renames the keys and sections of renames.h. Fails for text that is not TOML and for a key whose unit has
/// changed. Fails where a file has a key or a section under both names. Values are not checked. Allocates;
/// not for real time.
/// @param file  names the text in changes and errors
[[nodiscard]] std::expected<Migration, Diagnostic> migrate(std::string_view toml, std::string_view file);

/// The text of a file for another one: a relative URDF of hardware.robot is the same file from there.
/// @param toml  valid TOML
[[nodiscard]] std::string moved(std::string_view toml, std::string_view file, std::string_view other);

}  // namespace stilt::configuration
