#include "hal/can/bus_load.h"

namespace stilt::hal {
namespace {

constexpr std::uint32_t kInterframeSpace = 3;
constexpr std::uint32_t kEndOfFrame = 7;
constexpr std::uint32_t kAcknowledge = 2;  // slot and delimiter
constexpr std::uint32_t kChecksumDelimiter = 1;
constexpr std::uint32_t kLongestShortChecksum = 16;  // data bytes that CRC-17 protects; CRC-21 beyond

constexpr std::uint32_t stuff_bits(std::uint32_t bits) noexcept { return (bits - 1) / 4; }

FrameBits classic(const PeriodicFrame& frame) noexcept {
  const std::uint32_t stuffed = (frame.extended ? 54u : 34u) + 8u * frame.length;
  return {stuffed + stuff_bits(stuffed) + kChecksumDelimiter + kAcknowledge + kEndOfFrame + kInterframeSpace,
          0};
}

FrameBits flexible(const PeriodicFrame& frame) noexcept {
  // Start of frame to BRS: SOF, 11 + (SRR, IDE, 18) bits of identifier, RRS, (IDE), FDF, reserved, BRS.
  const std::uint32_t arbitration = frame.extended ? 36 : 17;
  const std::uint32_t control_and_data = 1 + 4 + 8u * frame.length;  // ESI, DLC, data
  const std::uint32_t checksum = 4 + (frame.length <= kLongestShortChecksum ? 17u : 21u);
  const std::uint32_t fixed_stuff = 1 + checksum / 4;
  const std::uint32_t nominal =
      arbitration + stuff_bits(arbitration) + kAcknowledge + kEndOfFrame + kInterframeSpace;
  const std::uint32_t data =
      control_and_data + (control_and_data + 3) / 4 + checksum + fixed_stuff + kChecksumDelimiter;
  return frame.bit_rate_switch ? FrameBits{nominal, data} : FrameBits{nominal + data, 0};
}

}  // namespace

FrameBits worst_case_bits(const PeriodicFrame& frame) noexcept {
  return frame.fd ? flexible(frame) : classic(frame);
}

double worst_case_duration_s(const PeriodicFrame& frame, const BusSpeed& speed) noexcept {
  const FrameBits bits = worst_case_bits(frame);
  return bits.nominal / speed.nominal_bit_s + bits.data / speed.data_bit_s;
}

BusLoad bus_load(std::span<const PeriodicFrame> frames, const BusSpeed& speed) noexcept {
  BusLoad load;
  for (const PeriodicFrame& frame : frames)
    load.fraction += frame.rate_hz * worst_case_duration_s(frame, speed);
  if (load.fraction > kRefusedLoad) {
    load.verdict = BusLoadVerdict::refused;
  } else if (load.fraction > kHighLoad) {
    load.verdict = BusLoadVerdict::high;
  }
  return load;
}

}  // namespace stilt::hal
