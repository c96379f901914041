#pragma once

#include <cstdint>
#include <span>

namespace stilt::hal {

/// One kind of frame that is on the bus again and again.
struct PeriodicFrame {
  std::uint8_t length = 8;  ///< data bytes, a length its kind allows
  bool extended = false;
  bool fd = false;
  bool bit_rate_switch = false;
  double rate_hz = 1000;  ///< frames per second
};

/// Bit rates of a bus, bit/s.
struct BusSpeed {
  double nominal_bit_s = 1e6;
  double data_bit_s = 5e6;  ///< of the data phase with bit_rate_switch
};

/// Bits of a frame with as many stuff bits as its contents can force, the gap of three bits to the next
/// included.
struct FrameBits {
  std::uint32_t nominal = 0;  ///< at the nominal bit rate
  std::uint32_t data = 0;     ///< at the data bit rate
};

/// Worst case. Classic: g bits from start of frame to checksum, g = 34 + 8n (54 + 8n extended), can hold
/// (g - 1) / 4 stuff bits; 13 bits follow unstuffed. FD: stuffing by contents ends with the data; the
/// checksum has a stuff bit first and after every fourth bit. Sources: ISO 11898-1:2015; R. Davis et al.,
/// "Controller Area Network (CAN) schedulability analysis", Real-Time Systems 35 (2007), equation 1.
[[nodiscard]] FrameBits worst_case_bits(const PeriodicFrame& frame) noexcept;

[[nodiscard]] double worst_case_duration_s(const PeriodicFrame& frame, const BusSpeed& speed) noexcept;

/// What a load means for replies in time.
enum class BusLoadVerdict : std::uint8_t {
  fine,
  high,     ///< above 60 %: little room for retransmissions
  refused,  ///< above 80 %: replies would be late as a rule
};

inline constexpr double kHighLoad = 0.60;
inline constexpr double kRefusedLoad = 0.80;

/// Load of one bus, and what it means.
struct BusLoad {
  double fraction = 0;  ///< time the bus is busy per second
  BusLoadVerdict verdict = BusLoadVerdict::fine;
};

/// Load of one bus from everything that is periodically on it, commands and replies.
[[nodiscard]] BusLoad bus_load(std::span<const PeriodicFrame> frames, const BusSpeed& speed) noexcept;

}  // namespace stilt::hal
