#include "hal/can/fdcanusb/link_frames.h"

#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <ctime>

namespace stilt::hal::fdcanusb {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

std::int64_t now_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1'000'000'000 + time.tv_nsec;
}

std::uint32_t key_of(const CanFrame& frame) noexcept {
  return frame.id | (frame.extended ? 0x80000000u : 0u) | (frame.remote ? 0x40000000u : 0u);
}

}  // namespace

bool LinkFrames::connected() noexcept {
  const std::uint32_t now = link_.connection.load(std::memory_order_acquire);
  if (connection_ != 0 && now == connection_) return true;
  if (connection_ != 0) {
    connection_ = 0;
    ++counters_.disconnections;
    forget();
  }
  return false;
}

bool LinkFrames::reconnect() noexcept {
  if (connected()) return true;
  connection_ = link_.connection.load(std::memory_order_acquire);
  // Frames that came since the new connection began may be old: a read would take them for new.
  for (std::size_t i = 0; connection_ != 0 && i < link_.arrivals.capacity(); ++i) {
    if (link_.arrivals.front() == nullptr) break;
    link_.arrivals.pop();
  }
  return connection_ != 0;
}

bool LinkFrames::waits(const Sent& sent) const noexcept {
  return sent.sequence > link_.settled.load(std::memory_order_acquire);
}

/// The place of this identifier, else one that nothing waits for; nullptr: all are taken.
LinkFrames::Sent* LinkFrames::place_of(std::uint32_t key) noexcept {
  const auto own = std::find_if(sent_.begin(), sent_.end(),
                                [&](const Sent& sent) { return sent.sequence != 0 && sent.key == key; });
  if (own != sent_.end()) return &*own;
  const auto free = std::find_if(sent_.begin(), sent_.end(), [&](const Sent& sent) { return !waits(sent); });
  return free != sent_.end() ? &*free : nullptr;
}

BusStatus LinkFrames::hand_over(const CanFrame& frame) noexcept {
  if (!well_formed(frame) || frame.error || frame.length == 0) {
    ++malformed_;
    return BusStatus::malformed;
  }
  Sent* place = place_of(key_of(frame));
  if (place == nullptr || waits(*place)) {
    if (place != nullptr) ++place->refusals;
    ++counters_.withheld;
    return BusStatus::unconfirmed;
  }
  Command* command = link_.commands.claim();
  if (command == nullptr) {
    ++dropped_;
    return BusStatus::queue_full;
  }
  *command = {frame, ++sequence_, connection_, now_ns()};
  link_.commands.commit();
  *place = {key_of(frame), sequence_, 0};
  ++counters_.sent;
  return BusStatus::ok;
}

SendResult LinkFrames::send(std::span<const CanFrame> frames) noexcept {
  if (!connected()) return {0, BusStatus::disconnected};
  SendResult result;
  if (frames.size() > kMaximumBatch) {
    dropped_ += frames.size() - kMaximumBatch;
    frames = frames.first(kMaximumBatch);
    result.status = BusStatus::queue_full;
  }
  for (const CanFrame& frame : frames) {
    const BusStatus status = hand_over(frame);
    if (status == BusStatus::ok) {
      ++result.sent;
    } else {
      result.status = status;
    }
  }
  if (result.sent > 0) ring();
  count();
  return result;
}

ReceiveResult LinkFrames::receive(std::span<CanFrame> frames) noexcept {
  if (!connected()) return {0, BusStatus::disconnected};
  const std::size_t room = std::min(frames.size(), kMaximumBatch);
  ReceiveResult result;
  const CanFrame* arrival = link_.arrivals.front();
  for (; arrival != nullptr && result.received < room; arrival = link_.arrivals.front()) {
    frames[result.received++] = *arrival;
    link_.arrivals.pop();
  }
  counters_.received += result.received;
  result.status = arrival != nullptr ? BusStatus::more : BusStatus::ok;
  count();
  return result;
}

/// One byte; where the socket is full the thread is awake anyway.
void LinkFrames::ring() const noexcept {
  std::uint8_t byte = 0;
  iovec vector{&byte, 1};
  mmsghdr header{};
  header.msg_hdr.msg_iov = &vector;
  header.msg_hdr.msg_iovlen = 1;
  static_cast<void>(calls_.send_many(doorbell_, &header, 1, MSG_DONTWAIT | MSG_NOSIGNAL));
}

/// Some are counted at both ends of the link.
void LinkFrames::count() noexcept {
  counters_.dropped_full = dropped_ + link_.stale.load(kRelaxed);
  counters_.malformed = malformed_ + link_.malformed.load(kRelaxed);
  counters_.confirmed = link_.taken.load(kRelaxed);
  counters_.echoes_lost = given_up_ + link_.answers_lost.load(kRelaxed);
  counters_.dropped_received = link_.arrivals.dropped();
  counters_.error_frames = link_.error_reports.load(kRelaxed);
  counters_.bus_off = link_.bus_off.load(kRelaxed);
}

BusHealth LinkFrames::health() const noexcept {
  if (link_.bus_off.load(kRelaxed) != bus_off_seen_) return BusHealth::off;
  return link_.health.load(kRelaxed);
}

void LinkFrames::clear_bus_off() noexcept {
  if (health() == BusHealth::off) {
    bus_off_seen_ = link_.bus_off.load(kRelaxed);
    link_.restarts.store(link_.restarts.load(kRelaxed) + 1, std::memory_order_release);
    ring();
  }
  for (Sent& sent : sent_) {
    if (sent.refusals < kMayBeLost || !waits(sent)) continue;
    sent = {};
    ++given_up_;
  }
}

}  // namespace stilt::hal::fdcanusb
