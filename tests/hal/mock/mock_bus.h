#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/frame_bus.h"
#include "hal/driver/emulated_driver.h"
#include "hal/robot/clock.h"

namespace stilt::hal::mock {

/// A clock that a test turns.
class MockClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  [[nodiscard]] std::int64_t sleep_until(std::int64_t time_ns) noexcept override {
    if (time_ns > now_ns_) now_ns_ = time_ns;
    return now_ns_;
  }
  void advance(std::int64_t duration_ns) noexcept { now_ns_ += duration_ns; }

 private:
  std::int64_t now_ns_ = 1'000'000'000;
};

enum class FrameFault : std::uint8_t {
  lose,       ///< never arrives
  delay,      ///< arrives delay_ns later
  duplicate,  ///< arrives twice
  corrupt,    ///< one bit is different (which a real bus would catch, a driver's software not)
};

/// A fault that frames suffer while it lasts.
struct FaultRule {
  FrameFault fault = FrameFault::lose;
  std::uint32_t id = 0;
  bool any_id = true;
  std::int64_t from_ns = 0;
  std::int64_t until_ns = INT64_MAX;
  std::int64_t delay_ns = 0;
  std::uint16_t bit = 0;  ///< of the payload, for corrupt; beyond it: the length is one less
};

/// A bus in memory with emulated drivers, scripted frames and faults. Time comes from its clock.
/// Deterministic, fixed memory; what exceeds it counts as lost.
class MockBus final : public FrameBus {
 public:
  explicit MockBus(Clock& clock) noexcept : clock_(clock) {}

  /// Drivers receive what is sent and answer. At most kMaximumDrivers.
  void attach(EmulatedDriver& driver) noexcept;
  void add_fault(const FaultRule& rule) noexcept;
  void clear_faults() noexcept { rule_count_ = 0; }
  /// A frame that arrives at a time, without any driver.
  void script(const CanFrame& frame, std::int64_t due_ns) noexcept;

  void set_health(BusHealth health) noexcept { health_ = health; }
  void set_disconnected(bool disconnected) noexcept { disconnected_ = disconnected; }
  void set_queue_full(bool full) noexcept { queue_full_ = full; }

  /// Newest frames that were sent, oldest first.
  [[nodiscard]] std::span<const CanFrame> sent() const noexcept {
    return std::span(sent_).first(sent_count_);
  }
  void clear_sent() noexcept { sent_count_ = 0; }

  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override;
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override;
  [[nodiscard]] BusHealth health() const noexcept override { return health_; }
  void clear_bus_off() noexcept override { health_ = BusHealth::active; }
  [[nodiscard]] const BusCounters& counters() const noexcept override { return counters_; }

  static constexpr std::size_t kMaximumDrivers = 8;
  static constexpr std::size_t kMaximumRules = 16;
  static constexpr std::size_t kQueue = 256;

 private:
  struct Pending {
    CanFrame frame;
    std::int64_t due_ns = 0;
  };
  void deliver(const CanFrame& frame) noexcept;
  void enqueue(const CanFrame& frame, std::int64_t due_ns) noexcept;
  void remember(const CanFrame& frame) noexcept;
  void elapse() noexcept;

  Clock& clock_;
  std::array<EmulatedDriver*, kMaximumDrivers> drivers_{};
  std::size_t driver_count_ = 0;
  std::array<FaultRule, kMaximumRules> rules_{};
  std::size_t rule_count_ = 0;
  std::array<Pending, kQueue> queue_{};
  std::size_t queued_ = 0;
  std::array<CanFrame, kQueue> sent_{};
  std::size_t sent_count_ = 0;
  BusHealth health_ = BusHealth::active;
  bool disconnected_ = false;
  bool queue_full_ = false;
  BusCounters counters_;
};

}  // namespace stilt::hal::mock
