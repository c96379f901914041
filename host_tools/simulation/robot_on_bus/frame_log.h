#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hal/can/frame.h"

namespace stilt::robot_on_bus {

/// Every frame on the buses as text, one a line, in the notation of can-utils: `TICK BUS SENDER FRAME`,
/// SENDER being controller or robot, FRAME 123#0011 (classic, 3 digits; extended, 8 digits; remote #R; FD ##1
/// with the faster data phase, ##0 without; error frames with the flag 20000000 as candump shows them).
/// Nothing in it depends on the clock of the machine: two runs in lock-step give the same bytes. Sync frames
/// are left out.
class FrameLog {
 public:
  /// Writes nothing when the name is empty. Throws std::runtime_error, one sentence, when the file cannot be
  /// written.
  explicit FrameLog(const std::string& file);

  enum class Sender { controller, robot };
  void write(std::uint64_t tick, std::size_t bus, Sender sender, const hal::CanFrame& frame);

  /// Throws std::runtime_error, one sentence, when something could not be written.
  void close();

 private:
  std::string name_;
  std::ofstream file_;
};

/// The frame as can-utils writes it.
[[nodiscard]] std::string frame_text(const hal::CanFrame& frame);

}  // namespace stilt::robot_on_bus
