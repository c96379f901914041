#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/configuration/diagnostic.h"

namespace stilt::configuration {

/// A value for a key of a configuration file.
struct NewValue {
  std::string section;
  std::string key;
  std::string value;  ///< as TOML: 0.25, true, "a word"
};

/// The text with these values. A key that is there gets its value in place. Another is added at the end of
/// its section, with dots or in braces where the section is written so. A new section is added at the end of
/// the text. Comments, order and all else stay. Fails for text
/// that is not TOML. Values are not checked. Allocates; not for real time.
/// @param file  names the text in errors
[[nodiscard]] std::expected<std::string, Diagnostic> with_values(std::string_view toml, std::string_view file,
                                                                 std::span<const NewValue> values);

/// "section.key" of all that a text names; empty for text that is not TOML.
[[nodiscard]] std::vector<std::string> keys_of(std::string_view toml);

}  // namespace stilt::configuration
