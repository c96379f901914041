#include "hal/can/fdcanusb/adapter_session.h"

#include <algorithm>

namespace stilt::hal::fdcanusb {

void AdapterSession::begin(std::int64_t now_ns, std::uint64_t settled) noexcept {
  const SessionCounts counts = counts_;
  *this = AdapterSession();
  counts_ = counts;
  settled_ = answered_ = quiet_ = settled;
  now_ns_ = now_ns;
  stage_ = Stage::finding;
  // The empty line ends what a program that died may have begun.
  put("\n\ncan on\n");
  ask_status(now_ns);
}

void AdapterSession::put(std::string_view text) noexcept {
  if (output_first_ == output_end_) output_first_ = output_end_ = 0;
  if (text.size() > output_.size() - output_end_) return;  // has_room() was not asked
  std::copy(text.begin(), text.end(), output_.begin() + static_cast<std::ptrdiff_t>(output_end_));
  output_end_ += text.size();
}

void AdapterSession::ask(std::int64_t now_ns, Asked asked, std::uint64_t sequence,
                         std::string_view text) noexcept {
  pending_[end_++ % kMostPending] = {asked, sequence, now_ns};
  put(text);
}

void AdapterSession::ask_status(std::int64_t now_ns) noexcept {
  asked_ns_ = now_ns;
  status_pending_ = true;
  ask(now_ns, Asked::status, 0, "can status\n");
}

void AdapterSession::tick(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (!status_pending_ && now_ns - asked_ns_ >= kStatusPeriod_ns && has_room()) ask_status(now_ns);
}

bool AdapterSession::has_room() const noexcept {
  constexpr std::size_t kReserve = 8;  // commands that are no frames
  return end_ - first_ + kReserve < kMostPending && output_end_ + kReserve * kLongestCommand < output_.size();
}

void AdapterSession::send(std::int64_t now_ns, const CanFrame& frame, std::uint64_t sequence) noexcept {
  CommandText text;
  const std::size_t size = write_command(frame, text);
  if (size == 0) return skip(sequence);
  ask(now_ns, Asked::frame, sequence, std::string_view(text.data(), size));
}

void AdapterSession::skip(std::uint64_t sequence) noexcept {
  pending_[end_++ % kMostPending] = {Asked::skipped, sequence, now_ns_};
  pass_skipped();
}

void AdapterSession::restart(std::int64_t now_ns) noexcept {
  off_ = false;  // where it still is, that counts again
  asked_before_restart_ = status_pending_;
  ask(now_ns, Asked::control, 0, "can off\n");
  ask(now_ns, Asked::control, 0, "can on\n");
}

std::span<const char> AdapterSession::output() const noexcept {
  return std::span(output_).subspan(output_first_, output_end_ - output_first_);
}

void AdapterSession::written(std::size_t count) noexcept { output_first_ += count; }

std::size_t AdapterSession::push(std::span<const std::uint8_t> bytes) noexcept {
  if (input_first_ == input_end_) input_first_ = input_end_ = 0;
  const std::size_t count = std::min(bytes.size(), input_.size() - input_end_);
  std::copy_n(bytes.begin(), count, input_.begin() + static_cast<std::ptrdiff_t>(input_end_));
  input_end_ += count;
  return count;
}

bool AdapterSession::next(CanFrame& frame) noexcept {
  while (input_first_ < input_end_) {
    const char letter = input_[input_first_++];
    if (letter != '\r' && letter != '\n') {
      if (line_size_ < line_.size()) {
        line_[line_size_++] = letter;
      } else {
        too_long_ = true;
      }
      continue;
    }
    if (take_line(frame)) return true;
  }
  return false;
}

/// At the end of a line. True: it is a frame.
bool AdapterSession::take_line(CanFrame& frame) noexcept {
  const std::string_view text(line_.data(), line_size_);
  const bool too_long = too_long_;
  line_size_ = 0;
  too_long_ = false;
  if (text.empty()) return false;
  const Line line = too_long ? Line{} : read_line(text);
  switch (line.kind) {
    case LineKind::received:
      frame = line.frame;
      return ready();
    case LineKind::status:
      take_status(line.status);
      break;
    case LineKind::ok:
    case LineKind::refused:
    case LineKind::not_on:
      take_answer(line.kind);
      break;
    case LineKind::malformed:
      // What a program that died did not read may come first, cut off.
      if (stage_ != Stage::finding) ++counts_.malformed;
      break;
  }
  return false;
}

void AdapterSession::take_answer(LineKind kind) noexcept {
  if (stage_ == Stage::finding) return;
  if (stage_ == Stage::learning) {
    ok_follows_status_ = ok_follows_status_ || kind == LineKind::ok;
    return;
  }
  if (ok_owed_ && kind == LineKind::ok) {
    ok_owed_ = false;
    return;
  }
  if (first_ == end_) {
    ++counts_.malformed;  // an answer to nothing
    return;
  }
  const Asked asked = oldest().asked;
  if (asked == Asked::status) status_pending_ = false;
  if (kind != LineKind::ok && asked != Asked::control) ++counts_.error_reports;
  answered(asked == Asked::frame && kind == LineKind::ok);
  if (kind == LineKind::not_on && asked == Asked::frame) ask(now_ns_, Asked::control, 0, "can on\n");
}

/// The oldest command has its answer.
void AdapterSession::answered(bool taken) noexcept {
  const Pending& pending = oldest();
  if (pending.asked == Asked::frame) answered_ = pending.sequence;
  counts_.taken += taken ? 1 : 0;
  ++first_;
  pass_skipped();
}

void AdapterSession::pass_skipped() noexcept {
  for (; first_ != end_ && oldest().asked == Asked::skipped; ++first_) answered_ = oldest().sequence;
  if (!failing_) settled_ = answered_;
}

void AdapterSession::take_status(const ControllerStatus& status) noexcept {
  if (!status_pending_) {
    ++counts_.malformed;
    return;
  }
  while (oldest().asked != Asked::status) {  // in order: what stands before it is lost
    ++counts_.answers_lost;
    answered(false);
  }
  status_pending_ = false;
  answered(false);
  if (stage_ != Stage::ready) return meet(status);
  ok_owed_ = ok_follows_status_;
  judge(status);
}

/// The first answers of a connection. The README ends each answer with OK, the firmware not that to `can
/// status`.
void AdapterSession::meet(const ControllerStatus& status) noexcept {
  if (stage_ == Stage::finding) {
    stage_ = Stage::learning;
    return ask_status(now_ns_);
  }
  stage_ = Stage::ready;
  ok_owed_ = ok_follows_status_;
  judge(status);
}

void AdapterSession::judge(const ControllerStatus& status) noexcept {
  if (!asked_before_restart_) {
    if (status.off && !off_) ++counts_.bus_off;
    off_ = status.off;
  }
  asked_before_restart_ = false;
  health_ = status.passive ? BusHealth::passive : status.warning ? BusHealth::warning : BusHealth::active;
  if (status.failing()) {
    ++counts_.error_reports;
    failing_ = true;
    quiet_ = settled_;
  } else if (!status.quiet()) {
    failing_ = false;
    settled_ = answered_;
  } else if (failing_) {
    settled_ = quiet_;
    quiet_ = answered_;
  }
}

bool AdapterSession::silent(std::int64_t now_ns, std::int64_t timeout_ns) const noexcept {
  return first_ != end_ && now_ns - oldest().time_ns > timeout_ns;
}

}  // namespace stilt::hal::fdcanusb
