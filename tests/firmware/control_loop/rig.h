#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_task.h"
#include "mpc_core/gait/reference.h"
#include "tests/firmware/supervisor/printers.h"
#include "tests/robots.h"

/// The control loop and the planner over a scripted robot, without threads and clocks.
namespace stilt::control_loop::testing {

inline constexpr std::int64_t kTick_ns = 1'000'000;

/// A robot that stands still where it is put, follows on its way to sit, and remembers what is asked of it.
class ScriptedRobot final : public hal::Robot {
 public:
  hal::JointReadings readings;
  hal::BaseReading base;
  hal::JointBusStatus read_status = hal::JointBusStatus::ok;
  hal::JointBusStatus write_status = hal::JointBusStatus::ok;
  hal::EmergencyStopState emergency_stop = hal::EmergencyStopState::released;
  hal::BringUpProgress outcome{.ready = true, .stage = hal::bring_up::Stage::ready};
  std::uint64_t error_count = 0;
  bool silent = false;
  int writes = 0;
  int disables = 0;
  int begun = 0;
  int steps = 0;
  int restored = 0;
  hal::JointCommands commands;

  void read(std::int64_t now_ns, hal::RobotReadings& taken) noexcept override {
    for (hal::JointReading& reading : readings) {
      reading.missed_replies = silent ? reading.missed_replies + 1 : 0;
      if (!silent) reading.time_ns = now_ns;
    }
    taken = {readings, base, read_status, emergency_stop, error_count, {}};
  }
  hal::JointBusStatus write(const hal::JointCommands& wanted) noexcept override {
    commands = wanted;
    ++writes;
    return write_status;
  }
  hal::JointBusStatus disable() noexcept override {
    ++disables;
    return hal::JointBusStatus::ok;
  }
  void begin_bring_up() noexcept override { ++begun; }
  hal::BringUpProgress bring_up(std::int64_t) noexcept override {
    ++steps;
    return outcome;
  }
  void restore_buses() noexcept override { ++restored; }
};

class Rig {
 public:
  Rig() {
    robot = &testing_support::amber3m();
    configuration = configuration::load_robot("amber3m").value();
    EXPECT_EQ(planner.configure(*robot, configuration), control::ConfigureStatus::ok);
    cycle.configure(*robot, configuration, configuration.supervisor);
    cycle.attach(joints, mail);
    standing = gait::standing_state(robot->constants, configuration.reference.base_height_m, 0.0,
                                    configuration.gait.stand_half_width_m, true);
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      joints.readings[i].position_rad = standing[model::kFirstJoint + static_cast<int>(i)];
      joints.readings[i].velocity_rad_s = 0.0;
      joints.readings[i].state = hal::DriverState::enabled;
    }
    joints.base.pitch_rad = 0.0;
    joints.base.pitch_rate_rad_s = 0.0;
  }

  void ask(supervisor::RequestKind kind, double speed_m_s = 0.0) {
    command.request = {kind, command.request.number + 1, speed_m_s};
  }

  /// Ticks, with a plan every ten ticks in use five ticks later, unless the planner is off.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      mail.commands.writer() = command;
      mail.commands.publish();
      if (tick == due_ && fresh_) mail.plans.publish();
      cycle.tick({.now_ns = now_ns(), .wakeup_latency_ns = wakeup_latency_ns});
      levels.push_back(decision().level);
      if (level() == supervisor::FallbackLevel::sit) sit_down();
      record = *mail.telemetry.front();
      mail.telemetry.pop();
      if (planning && tick % 10 == 0) {
        fresh_ = planner.cycle(mail.requests.newest(), mail.plans.writer());
        due_ = tick + 5;
      }
      ++tick;
    }
  }

  /// From power-on to drivers that came up.
  void get_ready() {
    run(3);
    ask(supervisor::RequestKind::calibrate);
    run(3);
    ASSERT_EQ(state(), supervisor::State::ready);
  }

  /// From power-on to standing with the torque law fully in command.
  void stand() {
    get_ready();
    ask(supervisor::RequestKind::stand);
    run(static_cast<int>(1000 * configuration.supervisor.stand_ramp_s) + 100);
    ASSERT_EQ(state(), supervisor::State::stand);
    ASSERT_EQ(decision().ramp, 1.0);
  }

  /// Ticks until joints that are damped from now on may go limp.
  [[nodiscard]] int damped_ticks() const {
    return static_cast<int>(std::lround(1000 * configuration.supervisor.damped_before_off_s));
  }

  /// The emergency stop ends what the robot does; then reset and bring-up.
  void fall_and_get_ready() {
    joints.emergency_stop = hal::EmergencyStopState::pressed;
    run(10);
    joints.emergency_stop = hal::EmergencyStopState::released;
    ask(supervisor::RequestKind::reset);
    run(damped_ticks() + 10);
    ask(supervisor::RequestKind::calibrate);
    run(5);
    ASSERT_EQ(state(), supervisor::State::ready);
  }

  /// The planner ends, and this is its last plan: the newest one, changed.
  template <class Change>
  void plan_once_more(const Change& change) {
    planning = fresh_ = false;
    control::Plan& plan = mail.plans.writer();
    plan = mail.plans.newest();
    change(plan);
    mail.plans.publish();
  }

  /// Events of a kind that wait in the ring; all others are dropped.
  [[nodiscard]] std::vector<Event> take(Event::Kind kind) {
    std::vector<Event> events;
    while (const Event* event = mail.events.front()) {
      if (event->kind == kind) events.push_back(*event);
      mail.events.pop();
    }
    return events;
  }

  /// All four commands only damp.
  [[nodiscard]] bool only_damps() const {
    return std::ranges::all_of(joints.commands, [](const hal::JointCommand& joint) {
      return joint.kp_Nm_rad == 0 && joint.torque_Nm == 0 && joint.velocity_rad_s == 0;
    });
  }

  [[nodiscard]] std::int64_t now_ns() const { return 1'000'000'000 + tick * kTick_ns; }
  [[nodiscard]] const supervisor::SupervisorOutput& decision() const { return cycle.decision(); }
  [[nodiscard]] supervisor::State state() const { return cycle.decision().state; }
  [[nodiscard]] supervisor::FallbackLevel level() const { return cycle.decision().level; }

  const model::RobotModel* robot;
  configuration::Configuration configuration;
  Mailboxes mail;
  PlannerTask planner;
  ControlLoop cycle;
  ScriptedRobot joints;  ///< and torso, drivers, buses
  OperatorCommand command;
  model::StateVector standing;
  control_loop::TickRecord record;  ///< of the newest tick
  std::vector<supervisor::FallbackLevel> levels;
  bool planning = true;
  std::size_t held_joint = hal::kJoints;  ///< stands still while the others sit down; kJoints: none
  std::int64_t wakeup_latency_ns = 0;
  long long tick = 0;

 private:
  void sit_down() {
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      if (i != held_joint) joints.readings[i].position_rad = joints.commands[i].position_rad;
    }
  }

  long long due_ = -1;
  bool fresh_ = false;
};

class RigTest : public ::testing::Test {
 protected:
  RigTest() : rig(std::make_unique<Rig>()) {}
  std::unique_ptr<Rig> rig;
};

}  // namespace stilt::control_loop::testing
