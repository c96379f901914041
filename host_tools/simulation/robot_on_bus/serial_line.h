#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hal/can/socketcan/descriptor.h"

namespace stilt::robot_on_bus {

/// A serial port that a simulated sensor writes to: a pseudo-terminal, and a link of the port's name to it.
class SerialLine {
 public:
  /// @param path  of the port; must not exist
  /// Throws std::invalid_argument, one sentence, when the link cannot be made.
  explicit SerialLine(const std::string& path);
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  ~SerialLine();

  /// Never waits: what does not fit is lost, as on a line without a reader.
  void write(std::span<const std::uint8_t> bytes) const noexcept;

 private:
  std::string path_;
  hal::socketcan::Descriptor sensor_;  ///< its end
  hal::socketcan::Descriptor port_;    ///< kept open: the line stays when its reader leaves
};

}  // namespace stilt::robot_on_bus
