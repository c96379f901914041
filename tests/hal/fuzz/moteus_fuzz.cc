#include <array>
#include <limits>

#include "hal/moteus/moteus.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;
using namespace stilt::hal::moteus;

namespace {

struct Registers {
  std::array<double, 0x200> value{};
  std::size_t writes = 0;

  static double read(const void* context, std::uint32_t number) noexcept {
    const auto& value = static_cast<const Registers*>(context)->value;
    return number < value.size() ? value[number] : std::numeric_limits<double>::quiet_NaN();
  }
  static void write(void* context, std::uint32_t number, double value) noexcept {
    auto& registers = *static_cast<Registers*>(context);
    if (number < registers.value.size()) registers.value[number] = value;
    ++registers.writes;
  }
};

void check_reply(const MoteusDriver& driver, const CanFrame& frame) {
  MoteusReply reply;
  reply.torque_Nm = 1234;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  fuzz::check(status == DecodeStatus::ok || reply.torque_Nm == 1234,
              "a refused reply leaves the output alone");
}

void check_subframes(const CanFrame& frame) {
  SubframeReader reader(frame.payload());
  Subframe subframe;
  std::size_t subframes = 0;
  while (reader.next(subframe)) {
    ++subframes;
    const bool has_values = subframe.kind == SubframeKind::write || subframe.kind == SubframeKind::reply;
    if (!has_values) continue;
    fuzz::check(subframe.values.size() == subframe.count * bytes_of(subframe.resolution),
                "all values are there");
    for (std::uint32_t i = 0; i < subframe.count; ++i) static_cast<void>(value_of(subframe, i));
  }
  fuzz::check(subframes <= kMaximumFrameBytes, "a frame has no more subframes than bytes");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  const std::uint8_t choice = input.byte();
  MoteusDriver driver;
  driver.extra_encoder = choice % 4 - 1;
  const CanFrame frame = input.frame((choice & 0x40) != 0 ? 0x8001 : 0x100);
  check_reply(driver, frame);
  check_subframes(frame);
  Registers registers;
  CanFrame answer;
  bool answered = false;
  const DecodeStatus status =
      serve_frame(driver, frame, &registers, Registers::read, Registers::write, answer, answered);
  fuzz::check(registers.writes <= kMaximumFrameBytes, "a frame writes no more registers than it has bytes");
  if (status == DecodeStatus::ok && answered) {
    fuzz::check(fd_length(answer.length) == answer.length, "an answer has a length that exists");
    MoteusReply reply;
    const DecodeStatus back = decode_reply(driver, answer, reply);
    fuzz::check(back == DecodeStatus::ok || back == DecodeStatus::not_finite, "an answer can be decoded");
  }
  return 0;
}
