#pragma once

#include <CLI/App.hpp>
#include <expected>
#include <string>

namespace stilt::program {

/// An option before a command must be one of the command. It must not be behind the command again: one of the
/// two would be dropped. The error is a sentence for the user.
[[nodiscard]] std::expected<void, std::string> check_options_before(const CLI::App& app);

/// --print-config takes what chooses the configuration, and --check-config what it checks as well. The error
/// is a sentence for the user.
[[nodiscard]] std::expected<void, std::string> check_options_of_reports(const CLI::App& app);

}  // namespace stilt::program
