#pragma once

#include <array>
#include <cstdint>

#include "firmware/control_loop/standing_pose.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/fault_detail.h"
#include "firmware/supervisor/state.h"
#include "hal/exchange/ring.h"
#include "hal/robot/robot.h"

namespace stilt::control_loop {

/// Something that happened in the torque loop and that people want to know.
struct Event {
  enum class Kind : std::uint8_t {
    state,            ///< the supervisor is in another state: `state`
    fault,            ///< a fault appeared: `fault`, by `found`
    waits_for_pose,   ///< to stand up was asked for, and the robot is not in a pose for that: `pose`
    bring_up_failed,  ///< of a driver: `bring_up`
    lost_stance,      ///< while it stood up the robot left the standing pose: `pose`
    fault_over,       ///< the cause of a fault is looked for, and is gone: `fault`
    stopped_waiting   ///< for the standing pose, `pose`: to stand up has to be asked for again
  };
  Kind kind = Kind::state;
  double time_s = 0.0;  ///< controller's clock
  supervisor::State state = supervisor::State::boot;
  supervisor::Fault fault = supervisor::Fault::not_finite;
  supervisor::FaultDetail found = {};
  hal::BringUpProgress bring_up = {};
  PoseMiss pose = {};
};

using EventRing = exchange::Ring<Event, 256>;

/// Torque loop only. A warning may come and go in every tick. While the ring is half full it is dropped and
/// counted, so that states and other faults find room. Real-time.
inline void push(EventRing& events, const Event& event) noexcept {
  const bool of_fault = event.kind == Event::Kind::fault || event.kind == Event::Kind::fault_over;
  const bool warns = of_fault && supervisor::row(event.fault).severity == supervisor::Severity::warning;
  events.push(event, warns ? EventRing::capacity() / 2 : 0);
}

}  // namespace stilt::control_loop
