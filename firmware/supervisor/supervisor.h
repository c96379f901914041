#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/supervisor/detectors.h"
#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/parameters.h"
#include "firmware/supervisor/state.h"
#include "hal/robot/joint_bus.h"
#include "mpc_core/gait/command.h"

namespace stilt::supervisor {

/// off: walk, step, stand, sit, damp, then the motors off (stop category 1 of IEC 60204-1). cut: the motors
/// off at once (category 0); a standing robot falls. Both end the program.
enum class RequestKind : std::uint8_t { none, calibrate, stand, step, walk, sit, reset, off, cut };
inline constexpr std::size_t kRequestKinds = 9;

/// Both end where no joint needs torque. They take their time, and stay asked for without the host.
[[nodiscard]] constexpr bool leads_to_rest(RequestKind kind) noexcept {
  return kind == RequestKind::sit || kind == RequestKind::off;
}

/// What the operator wants last. A request stands until it is met, replaced by one with a higher number, or
/// void. A fault and a lost heartbeat void what was asked for before, so that nothing moves again by itself.
/// A reset waits in a fault until the joints were damped.
struct Request {
  RequestKind kind = RequestKind::none;
  std::uint32_t number = 0;  ///< counts requests from 1
  double speed_m_s = 0;      ///< of walk; may change without a new number while walking; not finite: 0
};

/// What a tick of the supervisor takes.
struct SupervisorInputs {
  Observation seen;
  Request request;
  bool bring_up_done = false;  ///< every driver is enabled
  bool shut_down = false;      ///< the program is to end: sit, damp, disable the drivers
  bool fit_to_stand = true;    ///< nearly at rest and near the standing pose
  bool in_stance = true;       ///< still near enough to the standing pose to go on standing up
  bool at_rest = true;         ///< its plan has both feet down and hardly moves to its end
};

/// What leaves bound() for the drivers.
enum class Action : std::uint8_t {
  silent,    ///< nothing: boot and idle, faults of drivers that were left alone; in calibrate bring-up sends
  commands,  ///< the four commands
  disable,   ///< JointBus::disable()
};
inline constexpr std::size_t kActions = 3;

/// What a tick of the supervisor decides.
struct SupervisorOutput {
  State state = State::boot;
  FallbackLevel level = FallbackLevel::off;
  Reaction reaction = Reaction::none;  ///< hardest of the present and the latched faults
  FaultSet present;                    ///< causes that are there in this tick
  FaultSet raised;                     ///< those of them that were not there a tick before
  FaultSet ended;                      ///< those that were, are looked for, and are not there any more
  FaultSet latched;                    ///< waiting for a reset
  double ramp = 0;                     ///< share of the torque law while it is blended in, 0 to 1
  gait::GaitCommand gait;              ///< for the planner
  bool entered = false;                ///< the state changed in this tick
  bool start_controller = false;       ///< estimator and planner start anew from this tick's readings
  bool waits_to_stand = false;         ///< in ready, until the robot is fit to stand
  bool stand_void = false;             ///< in this tick the request to stand had waited for too long
  bool clear_buses = false;            ///< a reset was asked for: forget bus-off, clear faults of drivers
};

/// Decides in every tick what the joints may do: states as in kTransitions, faults as in kFaultTable, levels
/// as in fallback.h. update() comes before the torque law, bound() after it, and only the write may follow
/// bound(). Fixed memory; no call waits, allocates, locks or throws.
class Supervisor {
 public:
  void configure(const JointLimits& limits, const SupervisorParameters& parameters) noexcept;

  /// Skips the states before this one. The robot stands on its feet, its drivers are enabled, and the torque
  /// law has been in command long enough for any request. For simulations that begin there.
  void begin_standing(std::int64_t now_ns) noexcept;

  /// One tick: faults, transition, level.
  const SupervisorOutput& update(const SupervisorInputs& inputs) noexcept;

  /// What to send in this tick. Torques are within the joints' limits; commands that are not finite become
  /// damping, and a fault in the next tick.
  /// @param wanted    of the torque law or the gait; used at the levels plan, plan_feedback and gait only
  /// @param commands  written when the action is `commands`
  [[nodiscard]] Action bound(const hal::JointCommands& wanted, hal::JointCommands& commands) noexcept;

  [[nodiscard]] const SupervisorOutput& output() const noexcept { return output_; }

 private:
  /// Since the newest idle.
  enum class DriversAre : std::uint8_t { left_alone, being_brought_up, brought_up };

  void find_faults(const SupervisorInputs& inputs) noexcept;
  [[nodiscard]] FaultSet looked_for(const Observation& seen) const noexcept;
  void void_request_when_met(const Request& request) noexcept;
  void void_request_after_faults(const Request& request) noexcept;
  void watch_reset_window(const Request& request) noexcept;
  void give_up_waiting_to_stand(const Request& request) noexcept;
  void refuse_steps(const Request& request) noexcept;
  void move(const SupervisorInputs& inputs) noexcept;
  void enter(State state) noexcept;
  [[nodiscard]] bool applies(Condition condition, const SupervisorInputs& inputs) const noexcept;
  [[nodiscard]] bool requested(RequestKind kind, const Request& request) const noexcept;
  [[nodiscard]] bool passes(Guard guard) const noexcept;
  [[nodiscard]] double ramp() const noexcept;
  [[nodiscard]] Reaction reaction_of_level() const noexcept;
  [[nodiscard]] bool was_damped() const noexcept;
  [[nodiscard]] bool stopped_for_good() const noexcept;
  void choose(const SupervisorInputs& inputs) noexcept;
  [[nodiscard]] hal::JointCommands commands_of_level(const hal::JointCommands& wanted) const noexcept;
  [[nodiscard]] hal::JointCommands unloading(const hal::JointValues& pose_rad) const noexcept;
  [[nodiscard]] double since_s(std::int64_t time_ns) const noexcept;

  JointLimits limits_;
  SupervisorParameters parameters_;
  SupervisorOutput output_;
  hal::JointReadings measured_;
  std::int64_t now_ns_ = 0;
  std::int64_t entered_ns_ = 0;        ///< the state
  std::int64_t damped_ns_ = 0;         ///< the joints last began to be damped, in ready or fault
  std::int64_t driven_ns_ = 0;         ///< the drivers last began to get commands
  std::int64_t tracking_ns_ = 0;       ///< the torque law last became active
  std::int64_t level_ns_ = 0;          ///< the level
  std::int64_t hold_ns_ = 0;           ///< position control became active: hold, sit
  std::int64_t reset_ns_ = 0;          ///< a reset began
  std::int64_t stopped_ns_ = 0;        ///< the emergency stop was latched
  std::int64_t stand_asked_ns_ = 0;    ///< in ready
  std::int64_t rest_ns_ = 0;           ///< the robot rested, or was not in stand
  std::uint32_t void_number_ = 0;      ///< requests up to this one are met or void
  std::uint32_t slow_number_ = 0;      ///< newest request while the heartbeat was lost
  hal::JointValues pose_rad_{};        ///< newest finite positions
  hal::JointValues level_pose_rad_{};  ///< pose_rad_ when the level was reached
  hal::JointValues stand_pose_rad_{};  ///< pose_rad_ when the torque law became active
  hal::JointCommands followed_{};      ///< newest of plan or gait
  DriversAre drivers_are_ = DriversAre::left_alone;
  /// They were not left alone before an idle. Since then they are kept off by a frame in each tick, whose
  /// answers show that they have their power.
  bool was_up_ = false;
  bool started_ = false;
  bool shutting_down_ = false;
  bool resetting_ = false;
  bool command_not_finite_ = false;
  bool heartbeat_lost_ = false;  ///< whether or not it is looked for
  bool slowing_ = false;         ///< since it was lost on a robot that walks or steps
  bool fit_to_stand_ = false;
  bool can_step_ = false;
};

}  // namespace stilt::supervisor
