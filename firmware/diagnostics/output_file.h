#pragma once

#include <expected>
#include <functional>
#include <span>
#include <string>
#include <string_view>

/// Files that a program writes for its user. Ordinary threads.
namespace stilt::diagnostics {

/// Why a file of that name cannot be written, in the words of the system. It or its folder is not writable,
/// the folder is missing or is none, the name is too long or that of a folder. Empty when it can, and for the
/// empty name and "-".
/// For programs that run for a long time before they write.
[[nodiscard]] std::string why_not_writable(const std::string& name);

/// A file and the option that names it.
struct NamedFile {
  std::string option, path;
};

/// Refuses outputs of one run that would replace each other or an input, and more than one "-". One sentence,
/// empty where each has its place. Devices and FIFOs may stand for several.
[[nodiscard]] std::string conflict(std::span<const NamedFile> outputs, std::span<const std::string> inputs);

/// Replaces the file by the text, whole or not at all. The text goes to a file beside it, to the disk, and
/// under its name then. Permissions and symbolic links stay. Devices and FIFOs are written to; "-" is
/// standard output. The error is the system's reason.
[[nodiscard]] std::expected<void, std::string> write_file(const std::string& name, std::string_view text);

/// The same with a long text in pieces.
/// @param next  gives the next piece, an empty one at the end
/// @param wait  for the disk, which may take seconds. Without, the text is on its way there, and a loss of
///              power within seconds may lose it
[[nodiscard]] std::expected<void, std::string> write_file(const std::string& name,
                                                          const std::function<std::string_view()>& next,
                                                          bool wait = true);

/// Waits until a file that was written is on the disk. False: the system gives an error.
bool wait_for_disk(const std::string& name);

}  // namespace stilt::diagnostics
