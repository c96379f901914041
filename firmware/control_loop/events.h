#pragma once

#include <array>
#include <cstdint>

#include "firmware/exchange/ring.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "hal/bring_up/bring_up.h"
#include "hal/driver/driver_fault.h"

namespace stilt::control_loop {

/// Something that happened in the torque loop and that people want to know.
struct Event {
  enum class Kind : std::uint8_t {
    state,            ///< the supervisor is in another state: `state`
    fault,            ///< a fault appeared: `fault`
    waits_for_pose,   ///< to stand up was asked for, and the robot is not in a pose for that
    bring_up_failed,  ///< of the driver of `joint`: `failure`, `driver_fault`
    lost_stance       ///< while it stood up the robot left the standing pose
  };
  Kind kind = Kind::state;
  double time_s = 0.0;  ///< controller's clock
  supervisor::State state = supervisor::State::boot;
  supervisor::Fault fault = supervisor::Fault::not_finite;
  std::uint8_t joint = 0;
  hal::bring_up::Failure failure = hal::bring_up::Failure::none;
  hal::DriverFault driver_fault = hal::DriverFault::none;
};

using EventRing = exchange::Ring<Event, 256>;

}  // namespace stilt::control_loop
