#include "hal/moteus/moteus_zero.h"

#include <array>
#include <string_view>

namespace stilt::hal::moteus {
namespace {

constexpr std::array<std::string_view, 3> kCommands{"d cfg-set-output 0", "conf write", "d exact 0"};

}  // namespace

CanFrame MoteusZero::next(bool lost) noexcept {
  CanFrame frame;
  if (stopped_) {
    static_cast<void>(console_.ask(driver_, kCommands[command_], lost, frame));  // a valid driver
  } else {
    static_cast<void>(encode_stop(driver_, MoteusQuery::state, frame));
  }
  return frame;
}

ZeroProgress MoteusZero::take(const CanFrame& frame) noexcept {
  if (!stopped_) {
    MoteusReply reply;
    const bool stopped = decode_reply(driver_, frame, reply) == DecodeStatus::ok && reply.has_mode &&
                         reply.mode == static_cast<std::uint8_t>(MoteusMode::stopped);
    if (!stopped) return ZeroProgress::none;
    stopped_ = true;
    console_.begin();
    return ZeroProgress::more;
  }
  switch (console_.take(driver_, frame)) {
    case ConsoleReader::Progress::none:
      return ZeroProgress::none;
    case ConsoleReader::Progress::more:
      return ZeroProgress::more;
    case ConsoleReader::Progress::failed:
      return ZeroProgress::failed;
    case ConsoleReader::Progress::answer:
      break;
  }
  if (console_.answer() != "OK") return ZeroProgress::failed;
  return ++command_ < kCommands.size() ? ZeroProgress::more : ZeroProgress::done;
}

}  // namespace stilt::hal::moteus
