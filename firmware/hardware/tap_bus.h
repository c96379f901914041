#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "hal/frame_bus.h"

namespace stilt::hardware {

/// A bus whose received frames are also kept, so that bring-up sees what the readings are decoded from. Keeps
/// the first kKept frames since forget(). Real-time safe.
class TapBus final : public hal::FrameBus {
 public:
  static constexpr std::size_t kKept = 64;

  /// @param inner  outlives this object
  void attach(hal::FrameBus& inner) noexcept { inner_ = &inner; }

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    return inner_->send(frames);
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    const hal::ReceiveResult result = inner_->receive(frames);
    const std::size_t taken = std::min(result.received, kKept - count_);
    std::copy_n(frames.begin(), taken, kept_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ += taken;
    return result;
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override { return inner_->health(); }
  void clear_bus_off() noexcept override { inner_->clear_bus_off(); }
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return inner_->counters(); }

  [[nodiscard]] std::span<const hal::CanFrame> kept() const noexcept {
    return std::span(kept_).first(count_);
  }
  void forget() noexcept { count_ = 0; }

 private:
  hal::FrameBus* inner_ = nullptr;
  std::size_t count_ = 0;
  std::array<hal::CanFrame, kKept> kept_{};
};

}  // namespace stilt::hardware
