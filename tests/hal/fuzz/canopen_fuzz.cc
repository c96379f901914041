#include "hal/canopen/encoder.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;

// Frames with identifiers of its node to an encoder that is being started, and while it reports.
int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t kStepBytes = 10;
  constexpr std::uint32_t kIds[] = {0x585, 0x185, 0x705, 0x000};
  constexpr std::int64_t kMillisecond_ns = 1'000'000;
  fuzz::Input input(bytes, size);
  const std::uint8_t flags = input.byte();
  const canopen::Encoder encoder{.node = 5, .speed_rad_s = (flags & 1) != 0 ? 0.001 : 0.0};
  canopen::EncoderReader reader(encoder, 1 + (flags >> 1 & 3));
  std::int64_t now_ns = 1000 * kMillisecond_ns;
  for (std::size_t i = 0; i < size / kStepBytes; ++i) {
    now_ns += kMillisecond_ns * input.byte();
    if (const auto frame = reader.step(now_ns)) fuzz::check(well_formed(*frame), "what is sent can exist");
    const std::uint8_t kind = input.byte();
    CanFrame received = classic_frame(kIds[kind & 3], static_cast<std::uint8_t>((kind >> 2) % 9));
    for (std::size_t at = 0; at < kClassicFrameBytes; ++at) received.data[at] = input.byte();
    canopen::EncoderPosition position;
    position.angle_rad = -1;
    if (reader.take(now_ns, received, position) == DecodeStatus::ok) {
      fuzz::check(position.angle_rad >= 0 && position.angle_rad < 1e6, "an angle is within 32 bits");
      fuzz::check(std::isfinite(position.speed_rad_s) == (encoder.speed_rad_s != 0), "a speed is reported");
    } else {
      fuzz::check(position.angle_rad == -1, "a refused frame leaves the output alone");
    }
    static_cast<void>(sentence(reader.trouble(), encoder));
  }
  return 0;
}
