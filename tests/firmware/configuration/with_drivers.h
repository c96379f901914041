#pragma once

#include <string>

namespace stilt::configuration {

/// The configuration with drivers of one protocol everywhere, and more lines of other sections.
inline std::string with_drivers(const std::string& protocol, const std::string& driver_lines,
                                const std::string& more = "") {
  std::string toml;
  for (const char* section : {"[hip_driver]", "[knee_driver]"}) {
    toml.append(section).append("\nprotocol = \"").append(protocol).append("\"\n").append(driver_lines);
  }
  return toml + more;
}

}  // namespace stilt::configuration
