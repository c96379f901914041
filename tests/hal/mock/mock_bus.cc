#include "tests/hal/mock/mock_bus.h"

#include <algorithm>

namespace stilt::hal::mock {
namespace {

CanFrame corrupted(CanFrame frame, std::uint16_t bit) noexcept {
  if (bit / 8u < frame.length) {
    frame.data[bit / 8u] ^= static_cast<std::uint8_t>(1u << bit % 8u);
  } else if (frame.length > 0) {
    --frame.length;
  }
  return frame;
}

}  // namespace

void MockBus::attach(EmulatedDriver& driver) noexcept {
  if (driver_count_ < drivers_.size()) drivers_[driver_count_++] = &driver;
}

void MockBus::add_fault(const FaultRule& rule) noexcept {
  if (rule_count_ < rules_.size()) rules_[rule_count_++] = rule;
}

void MockBus::script(const CanFrame& frame, std::int64_t due_ns) noexcept { enqueue(frame, due_ns); }

void MockBus::enqueue(const CanFrame& frame, std::int64_t due_ns) noexcept {
  if (queued_ == queue_.size()) {
    ++counters_.dropped_received;
    return;
  }
  queue_[queued_++] = {frame, due_ns};
}

/// A driver's frame on its way, with the faults of the moment.
void MockBus::deliver(const CanFrame& frame) noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  CanFrame arriving = frame;
  std::int64_t due_ns = now_ns;
  int copies = 1;
  for (const FaultRule& rule : std::span(rules_).first(rule_count_)) {
    if (now_ns < rule.from_ns || now_ns >= rule.until_ns || !(rule.any_id || rule.id == frame.id)) continue;
    switch (rule.fault) {
      case FrameFault::lose:
        return;
      case FrameFault::delay:
        due_ns += rule.delay_ns;
        break;
      case FrameFault::duplicate:
        ++copies;
        break;
      case FrameFault::corrupt:
        arriving = corrupted(arriving, rule.bit);
        break;
    }
  }
  for (; copies > 0; --copies) enqueue(arriving, due_ns);
}

void MockBus::remember(const CanFrame& frame) noexcept {
  if (sent_count_ == sent_.size()) {
    std::move(sent_.begin() + 1, sent_.end(), sent_.begin());
    --sent_count_;
  }
  sent_[sent_count_++] = frame;
}

SendResult MockBus::send(std::span<const CanFrame> frames) noexcept {
  if (disconnected_) return {0, BusStatus::disconnected};
  if (queue_full_) {
    counters_.dropped_full += frames.size();
    return {0, BusStatus::queue_full};
  }
  SendResult result;
  for (const CanFrame& frame : frames) {
    if (!well_formed(frame)) {
      ++counters_.malformed;
      result.status = BusStatus::malformed;
      continue;
    }
    ++result.sent;
    remember(frame);
    if (health_ == BusHealth::off) continue;
    FrameSink replies;
    for (EmulatedDriver* driver : std::span(drivers_).first(driver_count_)) {
      driver->take(clock_.now_ns(), frame, replies);
    }
    for (const CanFrame& reply : replies.frames()) deliver(reply);
  }
  counters_.sent += result.sent;
  return result;
}

void MockBus::elapse() noexcept {
  FrameSink replies;
  for (EmulatedDriver* driver : std::span(drivers_).first(driver_count_))
    driver->elapse(clock_.now_ns(), replies);
  for (const CanFrame& reply : replies.frames()) {
    if (health_ != BusHealth::off) deliver(reply);
  }
}

ReceiveResult MockBus::receive(std::span<CanFrame> frames) noexcept {
  if (disconnected_) return {0, BusStatus::disconnected};
  elapse();
  const std::int64_t now_ns = clock_.now_ns();
  ReceiveResult result;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < queued_; ++i) {
    if (queue_[i].due_ns > now_ns || result.received == frames.size()) {
      if (queue_[i].due_ns <= now_ns) result.status = BusStatus::more;
      queue_[kept++] = queue_[i];
      continue;
    }
    frames[result.received++] = queue_[i].frame;
  }
  queued_ = kept;
  counters_.received += result.received;
  return result;
}

}  // namespace stilt::hal::mock
