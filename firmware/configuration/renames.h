#pragma once

#include <span>
#include <string>
#include <string_view>

/// Keys and sections that had another name in an earlier release. The parser refuses the old names and gives
/// the new ones; migrate.h rewrites files.
namespace stilt::configuration {

/// A key or section that had another name.
struct Rename {
  std::string_view section;
  std::string_view key;                ///< empty: the section itself was renamed
  std::string_view now;                ///< new name of the key, or of the section
  std::string_view value_change = {};  ///< what the user must do with the value; empty: it stays
};

[[nodiscard]] std::span<const Rename> renames();

/// The row of an old key, or nullptr. An empty key asks for the section itself.
[[nodiscard]] const Rename* find_rename(std::string_view section, std::string_view key = {});

/// "friction_mu is now friction_barrier_weight", and what the user must do with the value.
[[nodiscard]] std::string to_string(const Rename& rename);

}  // namespace stilt::configuration
