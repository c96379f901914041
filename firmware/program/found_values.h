#pragma once

#include <expected>
#include <span>
#include <string>

#include "firmware/configuration/edit.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// Writes values that a command has found to options.out_file. A file that is there is changed in place, with
/// its comments; otherwise it becomes a copy of the configuration that was read, with the values. The error
/// is one sentence for the user; nothing is written then, nor when the result would be refused as a
/// configuration.
[[nodiscard]] std::expected<void, std::string> write_values(const Options& options,
                                                            std::span<const configuration::NewValue> values);

}  // namespace stilt::program
