#include "hal/moteus/moteus_zero.h"

#include <array>
#include <string_view>

namespace stilt::hal::moteus {
namespace {

using Given = ConsoleReader::Given;

struct Command {
  std::string_view text;
  Given given;
};
constexpr std::array<Command, 3> kCommands{
    {{"d cfg-set-output 0", Given::again}, {"conf write", Given::once}, {"d exact 0", Given::again}}};

}  // namespace

CanFrame MoteusZero::next(bool lost) noexcept {
  CanFrame frame;
  if (stopped_) {
    const Command& command = kCommands[command_];
    static_cast<void>(console_.ask(driver_, command.text, lost, frame, command.given));  // a valid driver
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
      return ZeroProgress::unread;
    case ConsoleReader::Progress::answer:
      break;
  }
  if (console_.answer() != "OK") return ZeroProgress::failed;
  return ++command_ < kCommands.size() ? ZeroProgress::more : ZeroProgress::done;
}

}  // namespace stilt::hal::moteus
