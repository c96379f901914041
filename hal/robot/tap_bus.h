#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <span>

#include "hal/can/frame_bus.h"
#include "hal/robot/flexible_frames.h"

namespace stilt::hal {

/// A bus whose received frames are also kept: bring-up reads what the readings are decoded from. Frames can
/// be looked at before they are received. Drivers on CAN FD have their frames turned here. Keeps the first
/// kKept frames since forget(). Real-time safe.
class TapBus final : public FrameBus {
 public:
  static constexpr std::size_t kKept = 64;

  /// @param inner  outlives this object
  void attach(FrameBus& inner, const FlexibleFrames& flexible = {}) noexcept {
    inner_ = &inner;
    flexible_ = flexible;
  }

  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override {
    if (reconnecting()) return {0, BusStatus::disconnected};
    const SendResult result = inner_->send(turned(frames));
    disconnected_ = result.status == BusStatus::disconnected;
    return result;
  }
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override {
    if (reconnecting()) return {0, BusStatus::disconnected};
    const bool waited = early_count_ > 0;
    ReceiveResult result = waited ? take_early(frames) : inner_->receive(frames);
    if (!waited) turn_back(frames.first(result.received));
    disconnected_ = result.status == BusStatus::disconnected;
    const std::size_t taken = std::min(result.received, kKept - count_);
    std::copy_n(frames.begin(), taken, kept_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ += taken;
    return result;
  }

  /// Looks for frames without giving them away: they come with the next receive(), before later ones.
  /// @return  all that wait so
  [[nodiscard]] std::span<const CanFrame> listen() noexcept {
    const auto room = std::span(early_).subspan(early_count_);
    if (!room.empty() && !reconnecting()) {
      const std::size_t received = inner_->receive(room).received;
      turn_back(room.first(received));
      early_count_ += received;
    }
    return std::span(early_).first(early_count_);
  }
  [[nodiscard]] BusHealth health() const noexcept override {
    return reconnecting() ? BusHealth::active : inner_->health();
  }
  void clear_bus_off() noexcept override {
    if (!reconnecting()) inner_->clear_bus_off();
  }
  [[nodiscard]] const BusCounters& counters() const noexcept override {
    return reconnecting() ? counters_before_reconnect_ : inner_->counters();
  }

  /// Hands a bus that is gone to the thread that connects it again, outside the torque loop. Until
  /// end_reconnect() it is disconnected here and not touched. No effect when it is connected, or being
  /// reconnected.
  void begin_reconnect() noexcept {
    if (!disconnected_ || reconnecting()) return;
    counters_before_reconnect_ = inner_->counters();
    early_count_ = 0;
    reconnecting_.store(true, std::memory_order_release);
  }
  /// Whether it is being reconnected. The reconnecting thread has the inner bus to itself then.
  [[nodiscard]] bool reconnecting() const noexcept { return reconnecting_.load(std::memory_order_acquire); }
  /// Whether the newest call found it gone, or it is being reconnected.
  [[nodiscard]] bool disconnected() const noexcept { return disconnected_ || reconnecting(); }
  /// The attempt is over, with or without success.
  void end_reconnect() noexcept { reconnecting_.store(false, std::memory_order_release); }

  [[nodiscard]] std::span<const CanFrame> kept() const noexcept { return std::span(kept_).first(count_); }
  void forget() noexcept { count_ = 0; }

 private:
  [[nodiscard]] ReceiveResult take_early(std::span<CanFrame> frames) noexcept {
    const std::size_t taken = std::min(frames.size(), early_count_);
    std::copy_n(early_.begin(), taken, frames.begin());
    std::copy(early_.begin() + static_cast<std::ptrdiff_t>(taken),
              early_.begin() + static_cast<std::ptrdiff_t>(early_count_), early_.begin());
    early_count_ -= taken;
    return {taken, BusStatus::more};
  }

  /// The frames as they go on the bus.
  [[nodiscard]] std::span<const CanFrame> turned(std::span<const CanFrame> frames) noexcept {
    if (flexible_.empty() || frames.size() > kMaximumBatch) return frames;
    std::transform(frames.begin(), frames.end(), turned_.begin(),
                   [this](const CanFrame& frame) { return flexible_.to_bus(frame); });
    return std::span(turned_).first(frames.size());
  }
  /// Frames of the bus as the codecs take them.
  void turn_back(std::span<CanFrame> frames) const noexcept {
    if (flexible_.empty()) return;
    for (CanFrame& frame : frames) frame = flexible_.from_bus(frame);
  }

  FrameBus* inner_ = nullptr;
  FlexibleFrames flexible_;
  bool disconnected_ = false;  ///< by the newest call
  std::atomic<bool> reconnecting_ = false;
  BusCounters counters_before_reconnect_;
  std::array<CanFrame, kMaximumBatch> turned_{};
  std::size_t early_count_ = 0;
  std::array<CanFrame, kMaximumBatch> early_{};
  std::size_t count_ = 0;
  std::array<CanFrame, kKept> kept_{};
};

}  // namespace stilt::hal
