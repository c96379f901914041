#pragma once

#include <array>
#include <cstdint>

#include "firmware/controller/gait_fallback.h"
#include "firmware/controller/mailboxes.h"
#include "firmware/hardware/buses.h"
#include "firmware/hardware/drivers.h"
#include "firmware/supervisor/supervisor.h"
#include "hal/base_sensor.h"
#include "hal/emergency_stop.h"
#include "hal/joint_bus.h"
#include "mpc_core/control/estimator.h"
#include "mpc_core/control/torque_loop.h"

namespace stilt::controller {

/// The robot as the torque loop sees it; mocks in tests.
struct Robot {
  hal::JointBus* joints = nullptr;
  hal::BaseSensor* base = nullptr;
  hal::EmergencyStop* emergency_stop = nullptr;
  hardware::Drivers* drivers = nullptr;
  hardware::Buses* buses = nullptr;
};

/// What is known of a tick's time when it begins.
struct TickTiming {
  std::int64_t now_ns = 0;         ///< when it began
  std::int64_t late_ns = 0;        ///< after when it should have
  std::int64_t execution_ns = 0;   ///< duration of the tick before
  std::int64_t round_trip_ns = 0;  ///< newest known, from commands to the last reply
};

/// One tick of the torque loop. Knows no thread and no clock; everything outside comes in through
/// interfaces, so that robot, lock-step and tests run the very same ticks. Fixed memory, tick() is real-time
/// safe.
class TorqueCycle {
 public:
  void configure(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                 const supervisor::SupervisorParameters& supervision) noexcept;

  /// Tracks gaits of this library, which outlives this object, when no plan can be followed. After
  /// configure().
  void track_without_plan(const model::RobotModel& robot, const control::ControllerParameters& parameters,
                          const gait::GaitLibrary& library) noexcept {
    gait_.configure(robot, parameters.robot, &library);
  }

  /// Everything outlives this object.
  void attach(const Robot& robot, Mailboxes& mailboxes) noexcept;

  /// Sensors in, commands out. The first tick is time 0 of the controller's clock.
  void tick(const TickTiming& timing) noexcept;

  [[nodiscard]] const supervisor::SupervisorOutput& decision() const noexcept { return supervisor_.output(); }
  [[nodiscard]] double time_s() const noexcept { return reading_.time_s; }

 private:
  void take_tuning() noexcept;
  void sense(const TickTiming& timing) noexcept;
  void look_at_plan(const control::Plan& plan) noexcept;
  [[nodiscard]] bool near_standing_pose(double margin_rad) const noexcept;
  [[nodiscard]] bool fit_to_stand() const noexcept;
  [[nodiscard]] model::ContactMode contact(const control::Plan& plan) const noexcept;
  void follow_gait(const control::Plan& plan) noexcept;
  [[nodiscard]] supervisor::Pose planned_speed_rad_s(const control::Plan& plan) const noexcept;
  void estimate_state(const control::Plan& plan) noexcept;
  void supervise() noexcept;
  [[nodiscard]] hal::JointCommands torque_law(const control::Plan& plan) noexcept;
  void act(supervisor::Action action) noexcept;
  void bring_up() noexcept;
  void ask_for_plan() noexcept;
  void record(const TickTiming& timing, const hal::JointCommands& wanted, supervisor::Action action,
              const control::Plan& plan) noexcept;
  void report_events() noexcept;
  void push(const Event& event) noexcept;

  Robot robot_;
  Mailboxes* mail_ = nullptr;
  supervisor::Supervisor supervisor_;
  supervisor::JointLimits limits_;
  supervisor::SupervisorParameters supervision_;
  std::array<model::JointVector, 2> standing_rad_;  ///< left foot ahead, right foot ahead
  double standing_pitch_rad_ = 0.0;
  bool waiting_told_ = false;
  supervisor::State before_ = supervisor::State::boot;  ///< in the tick before
  control::Estimator estimator_;
  control::TorqueLoop law_;              ///< on a young plan
  control::TorqueLoop law_of_old_plan_;  ///< with the plan's feedback gains
  GaitFallback gait_;

  supervisor::Observation seen_;
  control::SensorReading reading_;
  model::StateVector estimate_ = model::StateVector::Zero();
  hal::JointCommands commands_{};
  hardware::DriversProgress bring_up_;
  OperatorCommand operator_;
  diagnostics::TickRecord record_;
  std::int64_t start_ns_ = 0;
  std::int64_t ticks_ = 0;
  std::uint64_t bus_errors_ = 0;
  std::uint32_t session_ = 0;   ///< 0: no plan is wanted
  std::uint32_t sessions_ = 0;  ///< ever begun
  double session_start_s_ = 0.0;
};

}  // namespace stilt::controller
