#include <array>
#include <bit>

#include "hal/sensors/torso_sensor_table.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;

namespace {

ChannelRow row_of(fuzz::Input& input) {
  ChannelRow row;
  row.id = 0x50 + (input.byte() & 1);
  const std::uint8_t kind = input.byte();
  row.order = (kind & 1) != 0 ? ByteOrder::big : ByteOrder::little;
  row.type = static_cast<RawType>((kind >> 1) % 3);
  row.bit_offset = static_cast<std::uint8_t>(kind >> 4 & 7);
  row.has_invalid = (kind & 0x80) != 0;
  row.byte_offset = input.byte();
  row.bits = input.byte();
  row.channel = static_cast<BaseChannel>(input.byte() % (kBaseChannels + 1));
  row.scale = std::bit_cast<float>(input.word());
  row.offset = std::bit_cast<float>(input.word());
  return row;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  std::array<ChannelRow, 2> table{row_of(input), row_of(input)};
  CanFrame frame = input.frame(0x50);
  ChannelValues values;
  const DecodeStatus status = decode(table, frame, values);
  if (status != DecodeStatus::ok) {
    fuzz::check(values.present == 0, "a refused frame leaves the output alone");
    return 0;
  }
  for (std::size_t i = 0; i < kBaseChannels; ++i) {
    const auto channel = static_cast<BaseChannel>(i);
    if (values.has(channel)) fuzz::check(std::isfinite(values[channel]), "channels are finite");
  }
  for (const ChannelRow& row : table) {
    const EncodeStatus encoded = encode(row, 1.0, frame);
    fuzz::check(encoded != EncodeStatus::not_finite, "a finite value is finite");
  }
  return 0;
}
