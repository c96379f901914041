#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>

#include "hal/can/socketcan/descriptor.h"

namespace stilt::hal::serial {

/// Bit rates that a port can be set to, of those VectorNav's units have.
[[nodiscard]] std::span<const int> bit_rates() noexcept;

/// What the program may do with a port.
enum class Access : std::uint8_t {
  read,
  read_write,
};

/// A serial port: 8 bits, no parity, one stop bit, no flow control, nothing translated. Not for
/// real-time threads: a call of the kernel's terminals takes locks.
class SerialPort {
 public:
  /// Opens the port for this program alone, and asks its adapter not to collect bytes where that can be
  /// asked. To write, it also takes the advisory lock (flock) that other programs for serial ports take. The
  /// lock holds for root and for every name of the port. The error is one sentence for the user.
  /// @param bit_rate_bit_s  of bit_rates()
  [[nodiscard]] static std::expected<SerialPort, std::string> open(const std::string& path,
                                                                   int bit_rate_bit_s,
                                                                   Access access = Access::read);

  /// What was written has a moment to leave. The rest is dropped: a device that takes no bytes does not hold
  /// the program up.
  ~SerialPort();
  SerialPort(SerialPort&&) noexcept = default;
  SerialPort& operator=(SerialPort&&) noexcept = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Waits for bytes. False: none came in time.
  [[nodiscard]] bool wait(std::int64_t timeout_ns) const noexcept;

  /// Reads what waits. @return  bytes read, 0 when none wait; -1: the port is gone
  [[nodiscard]] std::ptrdiff_t read(std::span<std::uint8_t> bytes) const noexcept;

  /// Writes what the port takes at once. @return  bytes taken, 0 when it is full; -1: the port is gone
  [[nodiscard]] std::ptrdiff_t write(std::span<const char> bytes) const noexcept;

  /// For poll().
  [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }

 private:
  explicit SerialPort(int descriptor) noexcept : descriptor_(descriptor) {}

  socketcan::Descriptor descriptor_;
  bool writes_ = false;  ///< the port is ours to write
};

}  // namespace stilt::hal::serial
