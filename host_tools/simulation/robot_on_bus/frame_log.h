#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hal/can/frame.h"

namespace stilt::robot_on_bus {

/// Every frame on the buses as text, one per line, in the notation of can-utils: `TICK BUS SENDER FRAME`.
/// SENDER is controller or robot. FRAME is like 123#0011: classic, 3 digits; extended, 8 digits; remote #R;
/// FD ##1 with the faster data phase, ##0 without; error frames with the flag 20000000 as in candump. The log
/// does not depend on the machine's clock: two runs in lock-step give the same bytes. Sync frames are left
/// out.
class FrameLog {
 public:
  /// Writes nothing when the name is empty, and to standard output when it is "-". Throws
  /// std::runtime_error, one sentence, when the file cannot be written.
  explicit FrameLog(const std::string& file);

  enum class Sender { controller, robot };
  void write(std::uint64_t tick, std::size_t bus, Sender sender, const hal::CanFrame& frame);

  /// Throws std::runtime_error, one sentence, when a part could not be written.
  void close();

 private:
  std::string name_;
  std::ofstream file_;
};

/// The frame in the notation of can-utils.
[[nodiscard]] std::string frame_text(const hal::CanFrame& frame);

}  // namespace stilt::robot_on_bus
