#pragma once

#include <expected>
#include <string>

namespace stilt::diagnostics {

/// All that a file or a FIFO holds. The error is the system's reason. The file is missing, is a folder,
/// cannot be read to its end, or has more than 64 MiB, as a device without an end. Ordinary threads.
[[nodiscard]] std::expected<std::string, std::string> read_file(const std::string& name);

}  // namespace stilt::diagnostics
