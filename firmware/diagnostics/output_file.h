#pragma once

#include <expected>
#include <string>
#include <string_view>

/// Files that a program writes for its user. Ordinary threads.
namespace stilt::diagnostics {

/// Why a file of that name cannot be written, in the words of the system: its folder is missing, or not
/// writable, or the name is that of a folder. Empty when it can, and for the empty name and "-". For programs
/// that run for a long time before they write.
[[nodiscard]] std::string why_not_writable(const std::string& path);

/// Replaces the file by the text, whole; "-" is standard output. The error is the system's reason.
[[nodiscard]] std::expected<void, std::string> write_file(const std::string& path, std::string_view text);

}  // namespace stilt::diagnostics
