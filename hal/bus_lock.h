#pragma once

#include <expected>
#include <string>

#include "hal/can/socketcan/descriptor.h"

namespace stilt::hal {

/// The right to command the drivers of a bus: of all programs on a machine one has it. An abstract Unix
/// socket of the bus's name, in the network namespace, as CAN interfaces are. The kernel gives it back when
/// the program ends, however it ends. Why not a lock file: docs/decisions/0019-stops-and-no-commander.md
class BusLock {
 public:
  /// The error is one sentence for the user. May not run in real time.
  [[nodiscard]] static std::expected<BusLock, std::string> take(const std::string& bus);

 private:
  explicit BusLock(int descriptor) noexcept : socket_(descriptor) {}

  socketcan::Descriptor socket_;
};

}  // namespace stilt::hal
