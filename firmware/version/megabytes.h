#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace stilt::version {

/// A size as all programs print it: "1.23 MB".
[[nodiscard]] inline std::string megabytes(std::size_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f MB", 1e-6 * static_cast<double>(bytes));
  return text;
}

}  // namespace stilt::version
