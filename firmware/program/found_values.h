#pragma once

#include <expected>
#include <span>
#include <string>

#include "firmware/configuration/edit.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// Looks before the run whether options.out_file, where it is there, is a configuration that values can go
/// to, with the wiring of the run. That is drivers, buses, identifiers and torso sensor. A trial writes every
/// key that the command may find, to a text alone. The error is for the user.
[[nodiscard]] std::expected<void, std::string> check_out_file(const Options& options);

/// Writes values that a command has found to options.out_file. A file that is there is changed in place, with
/// its comments. Otherwise it becomes a copy of the configuration that was read, with the values. What
/// --preset, --set and --bus have set is written, too: the values were found with it. The error is one
/// sentence for the user; nothing is written then, nor when the result would be refused as a configuration.
[[nodiscard]] std::expected<void, std::string> write_values(const Options& options,
                                                            std::span<const configuration::NewValue> values);

/// A line that names the file and what of the command line it got; for people.
[[nodiscard]] std::string written_text(const Options& options);

}  // namespace stilt::program
