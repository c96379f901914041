#include <array>

#include "hal/vectornav/vectornav.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;

namespace {

/// Messages in bytes that come in parts of this size; every angle a number.
int packets(std::span<const std::uint8_t> bytes, std::size_t part, vectornav::Packet& last) {
  vectornav::Stream stream;
  int count = 0;
  while (!bytes.empty()) {
    const std::size_t taken = stream.push(bytes.first(std::min(part, bytes.size())));
    fuzz::check(taken > 0, "a stream that is read has room");
    bytes = bytes.subspan(taken);
    while (stream.next(last)) {
      fuzz::check(std::isfinite(last.pitch_deg) && std::isfinite(last.roll_deg), "angles are finite");
      ++count;
    }
  }
  return count;
}

}  // namespace

// Bytes of a serial port: any, then one message, then enough zeros to end what is under suspicion.
int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t kMost = 400;
  std::array<std::uint8_t, kMost + vectornav::kPacketBytes + vectornav::Stream::kLongestPacket> line{};
  const std::size_t garbage = std::min(size, kMost);
  std::copy_n(bytes, garbage, line.begin());
  const auto message = vectornav::encode({1, 2.5, 3, {4, 5, 6}});
  std::copy(message.begin(), message.end(), line.begin() + static_cast<std::ptrdiff_t>(garbage));
  const auto whole =
      std::span<const std::uint8_t>(line).first(garbage + message.size() + vectornav::Stream::kLongestPacket);
  vectornav::Packet last, last_in_parts;
  const int at_once = packets(whole, whole.size(), last);
  const int in_parts = packets(whole, 1 + garbage % 17, last_in_parts);
  fuzz::check(at_once == in_parts, "parts make no difference");
  if (at_once > 0) fuzz::check(last.pitch_deg == last_in_parts.pitch_deg, "nor to the values");
  return 0;
}
