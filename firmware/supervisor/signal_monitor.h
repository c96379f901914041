#pragma once

#include <cstdint>

#include "firmware/supervisor/parameters.h"
#include "hal/robot/joint_bus.h"
#include "hal/sensors/torso_sensor.h"

/// What shows only over several ticks, for the detectors. Real-time safe.
namespace stilt::supervisor {

/// Of the joints and the torso. 0 where a sensor or driver does not report what is compared.
struct Signals {
  hal::JointValues encoder_jump_rad{};    ///< change of the newest angle that its rate does not explain
  double torso_mismatch_rad{};            ///< change of pitch less the integral of its rate, over about 0.2 s
  hal::JointValues torque_mismatch_Nm{};  ///< mean of reported less asked torque, over about 0.2 s
  hal::JointValues asked_torque_Nm{};     ///< mean size of the asked torque, over the same time
  hal::JointValues following_error_rad{};  ///< mean distance from what is followed, over about 0.05 s
};

/// What a tick has of them.
struct SignalInputs {
  std::int64_t time_ns = 0;
  const hal::JointReadings& joints;
  const hal::BaseReading& base;
  const hal::JointValues&
      asked_torque_Nm;  ///< of the commands that the newest replies answer, see asked_torque_Nm()
  const hal::JointValues& planned_position_rad;  ///< by what is followed now; NaN: nothing is
};

/// First-order low passes y' = (x - y) / T, and two that leak: y' = x' - y / T.
class SignalMonitor {
 public:
  /// One tick. The first one after reset() only keeps its values.
  const Signals& update(const SignalInputs& inputs) noexcept;

  /// While the joints get no torque but damping.
  void reset() noexcept { *this = SignalMonitor(); }

 private:
  void compare_encoders(const hal::JointReadings& joints) noexcept;
  void compare_torso(const hal::BaseReading& base) noexcept;

  Signals signals_;
  hal::JointReadings joints_;  ///< of the tick before
  hal::BaseReading base_;      ///< when its pitch was last new
  std::int64_t time_ns_ = 0;   ///< of the tick before; 0: none
};

/// |q - q_before - (v + v_before) / 2 dt|: change of an angle that its rate does not explain. 0 without one.
[[nodiscard]] double encoder_jump_rad(const hal::JointReading& before, const hal::JointReading& now) noexcept;

/// Torque of a driver that follows the law of a command from this reading on, within its limit, Nm.
[[nodiscard]] hal::JointValues asked_torque_Nm(const hal::JointCommands& commands,
                                               const hal::JointReadings& measured) noexcept;

}  // namespace stilt::supervisor
