#include "hal/robot/lockstep_bus.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/can/lockstep.h"

namespace stilt::hal {

SendResult LockstepBus::send_sync(std::uint64_t tick) noexcept {
  const CanFrame frame = sync_frame(kControllerSyncId, tick);
  return inner_->send(std::span(&frame, 1));
}

bool LockstepBus::listen() noexcept {
  if (first_ == last_) first_ = last_ = 0;
  std::array<CanFrame, kMaximumBatch> batch;
  while (true) {
    const ReceiveResult result = inner_->receive(batch);
    for (const CanFrame& frame : std::span(batch).first(result.received)) {
      std::uint64_t tick = 0;
      if (decode_sync(kRobotSyncId, frame, tick) == DecodeStatus::ok) {
        robot_tick_ = static_cast<std::int64_t>(tick);
      } else if (last_ < kKept) {
        kept_[last_++] = frame;
      }
    }
    if (result.status == BusStatus::disconnected) return false;
    if (result.status != BusStatus::more) return true;
  }
}

ReceiveResult LockstepBus::receive(std::span<CanFrame> frames) noexcept {
  ReceiveResult result;
  const bool connected = listen();
  result.received = std::min(frames.size(), last_ - first_);
  std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(first_), result.received, frames.begin());
  first_ += result.received;
  if (!connected) {
    result.status = BusStatus::disconnected;
  } else if (first_ < last_) {
    result.status = BusStatus::more;
  }
  return result;
}

bool LockstepClock::take_turns(std::uint64_t tick) noexcept {
  constexpr std::int64_t kPause_ns = 20'000;
  MonotonicClock clock;
  const std::int64_t give_up_ns = clock.now_ns() + std::llround(1e9 * patience_s_);
  for (LockstepBus& bus : buses_) {
    if (bus.send_sync(tick).sent != 1) return false;
  }
  const auto answered = [tick](const LockstepBus& bus) {
    return bus.robot_tick() == static_cast<std::int64_t>(tick);
  };
  while (true) {
    bool connected = true;
    for (LockstepBus& bus : buses_) connected = bus.listen() && connected;
    if (std::ranges::all_of(buses_, answered)) return true;
    const std::int64_t now_ns = clock.now_ns();
    if (!connected || now_ns > give_up_ns) return false;
    static_cast<void>(clock.sleep_until(now_ns + kPause_ns));
  }
}

bool LockstepClock::open() noexcept {
  lost_ = !take_turns(0);
  return !lost_;
}

std::int64_t LockstepClock::sleep_until(std::int64_t time_ns) noexcept {
  while (now_ns() < time_ns) {
    lost_ = lost_ || !take_turns(tick_ + 1);
    ++tick_;
  }
  return now_ns();
}

}  // namespace stilt::hal
