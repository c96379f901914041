#pragma once

#include <expected>
#include <string>
#include <string_view>

/// Files that a program writes for its user. Ordinary threads.
namespace stilt::diagnostics {

/// Why a file of that name cannot be written, in the words of the system: it or its folder is not writable,
/// the folder is missing, or the name is that of a folder. Empty when it can, and for the empty name and "-".
/// For programs that run for a long time before they write.
[[nodiscard]] std::string why_not_writable(const std::string& name);

/// Replaces the file by the text, whole or not at all: the text goes to a file beside it, to the disk, and
/// under its name then. Permissions and symbolic links stay. Devices and FIFOs are written to; "-" is
/// standard output. The error is the system's reason.
[[nodiscard]] std::expected<void, std::string> write_file(const std::string& name, std::string_view text);

}  // namespace stilt::diagnostics
