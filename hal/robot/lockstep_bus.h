#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/frame_bus.h"
#include "hal/robot/clock.h"

namespace stilt::hal {

/// A bus on which controller and simulated robot take turns (hal/can/lockstep.h): takes the robot's sync
/// frames out of what is received, and sends ours.
class LockstepBus final : public FrameBus {
 public:
  /// @param inner  outlives this object
  void attach(FrameBus& inner) noexcept { inner_ = &inner; }

  /// "All my frames of this tick are sent".
  [[nodiscard]] SendResult send_sync(std::uint64_t tick) noexcept;
  /// Newest tick the robot has finished; -1: none yet.
  [[nodiscard]] std::int64_t robot_tick() const noexcept { return robot_tick_; }
  /// Looks for the robot's sync without giving frames away: they come with the next receive(). False: the bus
  /// is gone.
  [[nodiscard]] bool listen() noexcept;

  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override {
    return inner_->send(frames);
  }
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override;
  [[nodiscard]] BusHealth health() const noexcept override { return inner_->health(); }
  void clear_bus_off() noexcept override { inner_->clear_bus_off(); }
  [[nodiscard]] const BusCounters& counters() const noexcept override { return inner_->counters(); }

 private:
  static constexpr std::size_t kKept = 256;

  FrameBus* inner_ = nullptr;
  std::int64_t robot_tick_ = -1;
  std::array<CanFrame, kKept> kept_{};
  std::size_t first_ = 0;
  std::size_t last_ = 0;
};

/// Virtual time: a tick is a millisecond of the robot, however long it takes.
class LockstepClock final : public Clock {
 public:
  /// @param buses       of the robot, outlive this object
  /// @param tick_ns     duration of a tick
  /// @param patience_s  how long the robot may take for one
  LockstepClock(std::span<LockstepBus> buses, std::int64_t tick_ns, double patience_s) noexcept
      : buses_(buses), tick_ns_(tick_ns), patience_s_(patience_s) {}

  /// Virtual; never 0.
  [[nodiscard]] std::int64_t now_ns() noexcept override {
    return (1 + static_cast<std::int64_t>(tick_)) * tick_ns_;
  }
  /// Ends our turn and waits for the robot's, a tick at a time, until the time is reached. Once the robot
  /// has not answered, lost() is true, and time goes on without it: no thread waits for ever.
  [[nodiscard]] std::int64_t sleep_until(std::int64_t time_ns) noexcept override;

  /// Opens the exchange. False: the robot does not answer in time.
  [[nodiscard]] bool open() noexcept;
  [[nodiscard]] bool lost() const noexcept { return lost_; }

 private:
  [[nodiscard]] bool take_turns(std::uint64_t tick) noexcept;

  std::span<LockstepBus> buses_;
  std::int64_t tick_ns_;
  double patience_s_;
  std::uint64_t tick_ = 0;
  bool lost_ = false;
};

}  // namespace stilt::hal
