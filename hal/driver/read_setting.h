#pragma once

#include <cstdio>
#include <string>

namespace stilt::hal {

/// A setting of a driver as it was read back, under the vendor's name.
struct ReadSetting {
  std::string name;
  std::string is;      ///< empty: no answer
  std::string wanted;  ///< by the configuration and docs/deployment.md
  bool right = false;
};

/// As short as it can be: 800, 12.5. Not real time.
[[nodiscard]] inline std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace stilt::hal
