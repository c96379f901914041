#pragma once

#include <cstdint>

#include "firmware/control_loop/gait_fallback.h"
#include "firmware/control_loop/mailboxes.h"
#include "firmware/control_loop/standing_pose.h"
#include "firmware/control_loop/torque_blend.h"
#include "firmware/supervisor/supervisor.h"
#include "hal/robot/robot.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/torque_law.h"

namespace stilt::control_loop {

/// What is known of a tick's time when it begins.
struct TickTiming {
  std::int64_t now_ns = 0;             ///< when it began
  std::int64_t wakeup_latency_ns = 0;  ///< after when it should have
  std::int64_t execution_ns = 0;       ///< duration of the tick before
  std::int64_t bus_round_trip_ns = 0;  ///< newest known, from commands to the last reply
};

/// The controller of the robot, tick by tick:
///
///   readings -> plan at this instant -> estimate -> decision -> torques -> bounded commands
///
/// Depends on no thread and no clock; the robot is behind one interface. Real time, lock-step, simulation and
/// replay run the same ticks. Fixed memory, tick() is real-time safe.
class ControlLoop {
 public:
  void configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                 const supervisor::SupervisorParameters& supervision) noexcept;

  /// Tracks gaits of this library, which outlives this object, when no plan can be followed. After
  /// configure().
  void track_without_plan(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                          const gait::GaitLibrary& library) noexcept {
    gait_.configure(robot, parameters, supervision_, &library);
  }

  /// Everything outlives this object.
  void attach(hal::Robot& robot, Mailboxes& mailboxes) noexcept;

  /// Begins on the feet, as after Stand, and asks for the first plan, for a simulation. Before the first
  /// tick, at its time.
  /// @param command      what the first plan is for
  /// @param known_state  as for tick()
  void begin_standing(std::int64_t now_ns, const gait::GaitCommand& command,
                      const model::StateVector* known_state = nullptr) noexcept;

  /// Sensors in, commands out. The first tick is time 0 of the controller's clock.
  /// @param known_state  replaces the sensors and the position of the base in the estimate, in a simulation
  void tick(const TickTiming& timing, const model::StateVector* known_state = nullptr) noexcept;

  [[nodiscard]] const supervisor::SupervisorOutput& decision() const noexcept { return supervisor_.output(); }
  /// The newest that was not off.
  [[nodiscard]] supervisor::State last_state() const noexcept { return last_state_; }
  /// Of the newest tick.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }

 private:
  /// The newest plan at the time of a tick.
  struct PlanView {
    bool exists = false;       ///< of this stance episode, not ended, and with the gait's foot on the ground
    double age_s = 0.0;        ///< since the state it started from, or since the episode began
    long long sequence = -1;   ///< of the newest plan, whether or not it exists for this tick
    control::PlanPoint point;  ///< when it exists
    control::BaseVelocity velocity_change = control::BaseVelocity::Zero();  ///< planned since the tick before
    supervisor::PlanUse use = supervisor::PlanUse::none;
    bool stands = false;                            ///< both feet stay down to its end
    Eigen::Vector3d end = Eigen::Vector3d::Zero();  ///< place and pitch of the base there
  };

  /// Of the joints, by what they follow. No position and no speed before they must follow.
  struct PlannedJoints {
    hal::JointValues position_rad;
    hal::JointValues speed_rad_s;
  };

  void take_tuning() noexcept;
  [[nodiscard]] control::SensorReading read(std::int64_t now_ns) noexcept;
  [[nodiscard]] PlanView plan_at(double time_s) const noexcept;
  [[nodiscard]] model::StateVector estimate_state(const control::SensorReading& sensors, const PlanView& plan,
                                                  const model::StateVector* known_state) noexcept;
  [[nodiscard]] supervisor::Followable track_gait(const control::SensorReading& reading,
                                                  const PlanView& plan) noexcept;
  [[nodiscard]] supervisor::Observation observe(const TickTiming& timing, const OperatorCommand& command,
                                                const PlanningResult& result,
                                                const control::SensorReading& reading, const PlanView& plan,
                                                const model::StateVector& estimate,
                                                const supervisor::Followable& followable) noexcept;
  [[nodiscard]] PlannedJoints planned_joints(const PlanView& plan) const noexcept;
  [[nodiscard]] bool at_rest(const PlanView& plan, const model::StateVector& estimate) const noexcept;
  const supervisor::SupervisorOutput& supervise(const supervisor::Observation& seen,
                                                const OperatorCommand& command,
                                                const control::SensorReading& reading, bool rests) noexcept;
  [[nodiscard]] model::StateVector begin_stance_episode(const control::SensorReading& reading,
                                                        const model::StateVector* known_state) noexcept;
  [[nodiscard]] hal::JointCommands torques(supervisor::FallbackLevel level,
                                           const control::SensorReading& reading, const PlanView& plan,
                                           const model::StateVector& estimate) noexcept;
  void send(supervisor::Action action, std::int64_t now_ns) noexcept;
  void bring_up(std::int64_t now_ns) noexcept;
  void request_plan(double time_s, const model::StateVector& estimate,
                    const gait::GaitCommand& command) noexcept;
  void record(const TickTiming& timing, const OperatorCommand& command, const PlanningResult& result,
              const PlanView& plan, const model::StateVector& estimate, const hal::JointCommands& wanted,
              supervisor::Action action) noexcept;
  void report_events(const supervisor::Observation& seen) noexcept;
  void push(const Event& event) noexcept;

  const model::RobotModel* model_ = nullptr;
  hal::Robot* robot_ = nullptr;
  Mailboxes* mail_ = nullptr;
  supervisor::JointLimits limits_;
  supervisor::SupervisorParameters supervision_;
  StandingPose standing_;
  double calm_m_s_ = 0.0;  ///< of a hip at rest
  PoseMiss stand_miss_;    ///< what keeps it from standing up
  PoseMiss stance_miss_;   ///< what keeps it from going on with that

  // What a tick leaves for the next one.
  supervisor::Supervisor supervisor_;
  control::Estimator estimator_;
  control::TorqueLaw law_;
  TorqueBlend blend_;
  supervisor::SignalMonitor monitor_;
  GaitFallback gait_;
  hal::RobotReadings readings_;  ///< newest of each channel
  hal::JointCommands commands_{};
  bool commanding_ = false;      ///< commands_ left in the tick before
  hal::JointValues asked_Nm_{};  ///< by commands_, at the newest readings; 0 without commands
  hal::JointBusStatus write_status_ = hal::JointBusStatus::ok;
  hal::BringUpProgress bring_up_;
  bool torques_finite_ = true;
  std::uint64_t errors_ = 0;  ///< of buses and codecs, counted
  std::uint32_t tuning_ = 0;  ///< number of the active live tunables
  std::int64_t start_ns_ = 0;
  std::int64_t ticks_ = 0;
  double time_s_ = 0.0;
  double last_time_s_ = 0.0;    ///< of the tick before
  std::uint32_t episode_ = 0;   ///< of stance; 0: no plan is wanted
  std::uint32_t episodes_ = 0;  ///< ever begun
  double episode_start_s_ = 0.0;
  bool waiting_reported_ = false;
  supervisor::State before_ = supervisor::State::boot;               ///< in the tick before
  supervisor::State last_state_ = supervisor::State::boot;           ///< the newest that was not off
  supervisor::Reaction kept_reaction_ = supervisor::Reaction::none;  ///< the newest in the black box
  TickRecord record_;
};

}  // namespace stilt::control_loop
