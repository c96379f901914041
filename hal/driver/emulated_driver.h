#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"

namespace stilt::hal {

/// Frames a driver sends, bounded; what does not fit is lost, as on a full bus.
class FrameSink {
 public:
  void push(const CanFrame& frame) noexcept {
    if (count_ < frames_.size()) frames_[count_++] = frame;
  }
  [[nodiscard]] std::span<const CanFrame> frames() const noexcept { return std::span(frames_).first(count_); }

 private:
  std::array<CanFrame, 16> frames_{};
  std::size_t count_ = 0;
};

/// A motor driver on the bus: answers frames, lets its watchdog expire, and computes the torque of its motor.
/// The owner of the motor (a test, a simulation) writes position and velocity and reads the torque. Fixed
/// memory, deterministic: time comes in, nothing is random.
class EmulatedDriver {
 public:
  struct Motor {
    double position_rad = 0;  ///< of the driver's shaft
    double velocity_rad_s = 0;
    double supply_V = 24;
    double temperature_C = 30;
  };
  Motor motor;

  /// A frame that was on the bus, for this driver or not.
  virtual void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept = 0;
  /// Time passes: watchdog, messages sent on a timer.
  virtual void elapse(std::int64_t now_ns, FrameSink& replies) noexcept = 0;
  /// Torque on the shaft at the motor's present position and velocity.
  [[nodiscard]] virtual double torque_Nm() const noexcept = 0;
  [[nodiscard]] virtual bool enabled() const noexcept = 0;
  /// Whether its frames report the supply voltage.
  [[nodiscard]] virtual bool reports_supply() const noexcept = 0;
  /// Position and velocity of an extra encoder; without effect on a driver that has none.
  virtual void set_encoder(std::size_t, double, double) noexcept {}
  /// Raises a fault: the motor coasts and the driver reports it in its own way.
  virtual void raise(DriverFault fault) noexcept = 0;
  /// As after a loss of power: everything configured at run time is gone, motor off. What the driver counts
  /// from power-up begins anew.
  virtual void power_cycle() noexcept = 0;

  /// The encoder goes on reporting what it reports now, whatever the motor does.
  void freeze_encoder(bool frozen) noexcept {
    frozen_ = frozen;
    frozen_motor_ = motor;
  }
  /// The driver answers as ever, and the motor gives no torque: one of its phases is open.
  void lose_torque(bool lost) noexcept { torque_lost_ = lost; }
  /// A driver without power neither answers nor drives.
  void set_powered(bool powered) noexcept { powered_ = powered; }
  [[nodiscard]] bool powered() const noexcept { return powered_; }
  [[nodiscard]] bool gives_torque() const noexcept { return powered_ && !torque_lost_; }

 protected:
  ~EmulatedDriver() = default;
  /// What the encoder reports.
  [[nodiscard]] Motor sensed() const noexcept {
    Motor counted = frozen_ ? frozen_motor_ : motor;
    counted.position_rad -= zero_rad_;
    return counted;
  }
  /// Counts from here on so that the present position is this.
  void count_from(double position_rad) noexcept {
    zero_rad_ = (frozen_ ? frozen_motor_ : motor).position_rad - position_rad;
  }
  /// Of the turns of its rotor, each so large at the shaft, it counts none but the nearest to its zero.
  void lose_turns(double turn_rad) noexcept { count_from(std::remainder(sensed().position_rad, turn_rad)); }
  [[nodiscard]] double zero_rad() const noexcept { return zero_rad_; }
  void set_zero_rad(double zero_rad) noexcept { zero_rad_ = zero_rad; }

 private:
  bool frozen_ = false;
  bool powered_ = true;
  bool torque_lost_ = false;
  Motor frozen_motor_;
  double zero_rad_ = 0;  ///< of the shaft, where the driver's position is 0
};

}  // namespace stilt::hal
