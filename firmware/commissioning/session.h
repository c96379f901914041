#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <limits>
#include <string>

#include "firmware/realtime/pace.h"
#include "hal/robot/clock.h"
#include "hal/robot/robot.h"

namespace stilt::commissioning {

[[nodiscard]] hal::JointValues joint_angles(const hal::RobotReadings& readings);

/// Reads without a new position or pitch: older readings are not current.
inline constexpr std::uint32_t kSilentReads = 20;

/// Ticks that disable the drivers at the end of a program. Where the echo of a driver's last command is lost,
/// a bus withholds the first 6 of them (hal::socketcan::Confirmations::kOvertaken).
inline constexpr int kLastTicks = 10;

/// Beyond these a joint gets no torque: those of the supervisor (firmware/supervisor/parameters.h). What a
/// driver does not report is NaN and within them. A stall is one of this loop.
struct DriverLimits {
  double overheated_C = std::numeric_limits<double>::infinity();  ///< driver or motor
  double low_voltage_V = 0.0;                                     ///< supply
  double high_voltage_V = std::numeric_limits<double>::infinity();
  double stall_s = std::numeric_limits<double>::infinity();  ///< from a tick that gives torque to the next
};

/// A robot without its controller: drivers are brought up, read and commanded at the rate of the torque
/// loop. What is not commanded is limp: no torque, no gain. Ordinary threads.
class Session {
 public:
  /// @param robot, clock, stop  outlive this object
  Session(hal::Robot& robot, hal::Clock& clock, std::int64_t tick_ns, const std::atomic<bool>& stop,
          const DriverLimits& limits = {})
      : robot_(robot),
        clock_(clock),
        stop_(stop),
        limits_(limits),
        tick_ns_(tick_ns),
        pace_(clock.now_ns() + tick_ns, tick_ns) {}

  /// All drivers enabled, at zero torque; at most 5 s. The error names joint and cause.
  [[nodiscard]] std::expected<void, std::string> bring_up();

  /// First half of a tick: waits for its time and reads. Returns when it began.
  std::int64_t begin_tick();
  /// Between both halves; what is not commanded is limp.
  void command(const hal::JointCommands& commands = {});
  /// Second half.
  void end_tick() { pace_.advance(began_ns_, clock_.now_ns()); }
  /// A tick with these commands; without any the robot is limp.
  void tick(const hal::JointCommands& commands = {});
  /// Every driver off. A bus withholds a frame until a read has seen the last one with its identifier leave.
  /// kLastTicks make this frame each driver's last.
  void disable();

  [[nodiscard]] const hal::RobotReadings& readings() const noexcept { return readings_; }
  /// When the present tick is due.
  [[nodiscard]] std::int64_t due_ns() const noexcept { return pace_.next_ns(); }
  [[nodiscard]] std::int64_t tick_ns() const noexcept { return tick_ns_; }
  [[nodiscard]] double tick_s() const noexcept { return 1e-9 * static_cast<double>(tick_ns_); }
  [[nodiscard]] hal::Clock& clock() noexcept { return clock_; }
  /// The first bus that is gone or off; empty: none is. Everything on it is silent.
  [[nodiscard]] std::string bus_trouble() const;
  /// What is wrong with stop, buses, drivers or their replies; empty: nothing. A driver that was idle since
  /// its bring-up, however briefly, gives no torque, or lost its settings: it stays named.
  [[nodiscard]] std::string trouble() const;
  /// Why the torso's pitch is not current; empty: it is. For commands that need it.
  [[nodiscard]] std::string torso_trouble() const;
  /// The same, a limit of a driver, and an emergency stop that is pressed or silent: before and while a joint
  /// gets torque. And stall_trouble().
  [[nodiscard]] std::string trouble_with_torque() const;
  /// The first temperature or supply beyond the limits of a driver, with that limit; empty: none is.
  [[nodiscard]] std::string limit_trouble() const;
  /// Why the loop stood still while a joint had torque; empty: it did not.
  [[nodiscard]] std::string stall_trouble() const;
  [[nodiscard]] bool stopped() const noexcept { return stop_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::string driver_trouble(std::size_t joint) const;

  hal::Robot& robot_;
  hal::Clock& clock_;
  const std::atomic<bool>& stop_;
  DriverLimits limits_;
  std::int64_t tick_ns_;
  realtime::Pace pace_;
  std::int64_t began_ns_ = 0;
  std::int64_t stall_ns_ = 0;  ///< from the tick before to this one, where that one gave torque
  bool gives_torque_ = false;  ///< the newest command
  bool is_up_ = false;         ///< bring_up() enabled all drivers
  std::array<bool, hal::kJoints> fell_idle_{};  ///< since then
  hal::RobotReadings readings_;
};

}  // namespace stilt::commissioning
