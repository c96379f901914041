#pragma once

#include <stilt/types.h>

#include <expected>
#include <string>

#include "firmware/configuration/configuration.h"

namespace stilt::library {

/// The configuration of a robot in the library; the error is one sentence, or several.
[[nodiscard]] std::expected<configuration::Configuration, std::string> read_settings(
    const Settings& settings);

/// An error with the library's names where it begins with an option of the programs.
[[nodiscard]] std::string with_library_names(std::string error);

}  // namespace stilt::library
