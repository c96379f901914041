#pragma once

#include <span>
#include <string>

namespace stilt::configuration {

/// One mistake in a configuration: where it is, what it is and what would be right.
struct Diagnostic {
  std::string file;  ///< path of the file, or the option of the command line, such as "--set"
  int line = 0;      ///< from 1; 0 when the place is not in a file or the whole file is meant
  int column = 0;    ///< from 1, in characters; 0 as for line
  std::string message;
};

/// "file:line:column: message", or "file: message" without a line. May allocate; not for real time.
[[nodiscard]] std::string to_string(const Diagnostic& diagnostic);

/// One line a diagnostic, without a newline at the end.
[[nodiscard]] std::string to_string(std::span<const Diagnostic> diagnostics);

}  // namespace stilt::configuration
