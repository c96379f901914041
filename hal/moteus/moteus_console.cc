#include "hal/moteus/moteus_console.h"

#include <algorithm>
#include <span>

namespace stilt::hal::moteus {
namespace {

constexpr std::uint32_t kChannel = 1;
constexpr std::uint32_t kPolledBytes = 48;
constexpr std::string_view kStopTelemetry = "tel stop\n";
constexpr unsigned kDrained = 3;        // replies without text: nothing is left over
constexpr unsigned kUnanswered = 20;    // replies without text: the question was lost
constexpr unsigned kMostReplies = 200;  // for one answer

std::span<const std::uint8_t> bytes_of_text(std::string_view text) noexcept {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Text of the first subframe of this kind on the command line.
std::optional<ConsoleText> text_of(const CanFrame& frame, SubframeKind kind) noexcept {
  SubframeReader reader(frame.payload());
  Subframe subframe;
  while (reader.next(subframe)) {
    const bool polled = kind == SubframeKind::stream_in && subframe.kind == SubframeKind::stream_poll;
    if ((subframe.kind != kind && !polled) || subframe.start != kChannel) continue;
    ConsoleText text;
    text.append({reinterpret_cast<const char*>(subframe.values.data()), subframe.values.size()});
    return text;
  }
  return std::nullopt;
}

}  // namespace

EncodeStatus encode_console(const MoteusDriver& driver, std::string_view text, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  writer.stream(SubframeKind::stream_in, kChannel, bytes_of_text(text));
  return writer.finish();
}

EncodeStatus encode_console_poll(const MoteusDriver& driver, CanFrame& frame) noexcept {
  if (!valid(driver)) return EncodeStatus::invalid;
  frame = frame_to(driver);
  SubframeWriter writer(frame);
  writer.poll_stream(kChannel, kPolledBytes);
  return writer.finish();
}

std::optional<ConsoleText> decode_console(const MoteusDriver& driver, const CanFrame& frame) noexcept {
  if (!is_reply_of(driver, frame)) return std::nullopt;
  return text_of(frame, SubframeKind::stream_out);
}

std::optional<ConsoleText> decode_console_request(const MoteusDriver& driver,
                                                  const CanFrame& frame) noexcept {
  if (!is_frame_to(driver, frame)) return std::nullopt;
  return text_of(frame, SubframeKind::stream_in);
}

EncodeStatus encode_console_answer(const MoteusDriver& driver, const CanFrame& request, std::string_view text,
                                   CanFrame& answer) noexcept {
  answer = answer_to(driver, request);
  SubframeWriter writer(answer);
  writer.stream(SubframeKind::stream_out, kChannel, bytes_of_text(text));
  return writer.finish();
}

void ConsoleReader::begin() noexcept {
  replies_ = 0;
  start_over();
}

void ConsoleReader::start_over() noexcept {
  step_ = Step::stop;
  quiet_ = 0;
  line_.clear();
}

/// It may have carried text that was left over, or be that of a command that was taken.
void ConsoleReader::lose_reply() noexcept {
  if (step_ == Step::drain) quiet_ = 0;
  if (step_ != Step::ask) return;
  step_ = Step::read;
  quiet_ = 0;
  line_.clear();
}

EncodeStatus ConsoleReader::ask(const MoteusDriver& driver, std::string_view command, bool lost,
                                CanFrame& frame, Given given) noexcept {
  given_ = given;
  if (lost) lose_reply();
  if (step_ == Step::stop) return encode_console(driver, kStopTelemetry, frame);
  if (step_ != Step::ask) return encode_console_poll(driver, frame);
  ConsoleText line;
  line.append(command);
  line.append("\n");
  return encode_console(driver, line.view(), frame);
}

ConsoleReader::Progress ConsoleReader::take(const MoteusDriver& driver, const CanFrame& frame) noexcept {
  const std::optional<ConsoleText> text = decode_console(driver, frame);
  if (!text) return Progress::none;
  quiet_ = text->view().empty() ? quiet_ + 1 : 0;
  const Progress unanswered = ++replies_ < kMostReplies ? Progress::more : Progress::failed;
  switch (step_) {
    case Step::stop:
      step_ = Step::drain;
      quiet_ = 0;
      return unanswered;
    case Step::drain:
      if (quiet_ >= kDrained) step_ = Step::ask;
      return unanswered;
    case Step::ask:
      line_.clear();
      step_ = Step::read;
      quiet_ = 0;
      break;
    case Step::read:
      break;
  }
  line_.append(text->view());
  const bool ended = std::ranges::any_of(line_.view(), [](char each) { return each == '\n'; });
  if (ended && !answer().empty()) {
    step_ = Step::ask;
    replies_ = 0;
    return Progress::answer;
  }
  if (given_ == Given::once) return ended ? Progress::failed : unanswered;
  if (ended || quiet_ >= kUnanswered) start_over();
  return unanswered;
}

std::string_view ConsoleReader::answer() const noexcept {
  const std::string_view line = line_.view();
  const auto* const end = std::ranges::find_if(line, [](char each) { return each == '\r' || each == '\n'; });
  return {line.begin(), end};
}

}  // namespace stilt::hal::moteus
