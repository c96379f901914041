#pragma once

#include <fstream>
#include <string>

namespace stilt::realtime {

/// First line of a file under /sys or /proc; empty when there is none. Start-up and ordinary threads.
[[nodiscard]] inline std::string first_line(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  return line;
}

}  // namespace stilt::realtime
