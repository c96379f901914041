#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/configuration/reach.h"
#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/planner_task.h"
#include "hal/robot/emulated_joint.h"
#include "hal/robot/robot_hardware.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/gait/reference.h"
#include "tests/hal/mock/mock_bus.h"
#include "tests/robots.h"

/// The control loop over emulated drivers of one vendor on two buses in memory, in virtual time. The joints
/// stand in the standing pose; their encoders show noise.
namespace stilt::control_loop::testing {

class RecoveryRig {
 public:
  static constexpr std::int64_t kTick_ns = 1'000'000;

  explicit RecoveryRig(configuration::DriverProtocol protocol)
      : buses_{hal::mock::MockBus(clock_), hal::mock::MockBus(clock_)} {
    configuration_ = configuration::load_robot("amber3m").value();
    configuration_.supervisor.damped_before_off_s = 0.5;  // thousands of cases wait for it
    for (configuration::DriverParameters* driver :
         {&configuration_.hardware.hip, &configuration_.hardware.knee}) {
      driver->protocol = protocol;
      driver->accept_missing_watchdog = true;
      if (protocol == configuration::DriverProtocol::ak_v3) driver->position_range_rad = 12.56;
      driver->odrive_watchdog_timeout_endpoint = 0x191;
      driver->odrive_enable_watchdog_endpoint = 0x192;
      driver->odrive_firmware_version = "0.6.11";
      driver->odrive_hardware_version = "4.4.58";
    }
    const hal::RobotWiring wiring = configuration::robot_wiring(configuration_.hardware, 1e9 / kTick_ns);
    const model::RobotModel& robot = testing_support::amber3m();
    hal::BringUpOptions options;
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      options[i] = configuration::bring_up_options(
          configuration_.hardware, i, robot.constants.position_min_rad[i] - configuration::kTravelMargin_rad,
          robot.constants.position_max_rad[i] + configuration::kTravelMargin_rad);
      emulators_[i] = std::make_unique<hal::JointEmulator>(hal::make_emulator(wiring.joints[i].driver));
      buses_[wiring.joints[i].bus].attach(driver(i));
    }
    const model::StateVector standing =
        gait::standing_state(robot.constants, configuration_.reference.base_height_m, 0.0,
                             configuration_.gait.stand_half_width_m, true);
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      const hal::JointWiring& joint = wiring.joints[i];
      driver(i).motor.position_rad = joint.direction * joint.ratio *
                                     (standing[model::kFirstJoint + static_cast<int>(i)] - joint.offset_rad);
      driver(i).motor.supply_V = 48;
    }
    hardware_ = std::make_unique<hal::RobotHardware>(wiring, options,
                                                     std::array<hal::FrameBus*, 2>{&buses_[0], &buses_[1]});
    EXPECT_EQ(planner_.configure(robot, configuration_), control::ConfigureStatus::ok);
    loop_.configure(robot, configuration_, configuration_.supervisor);
    EXPECT_TRUE(gait_files::load_shipped_library("amber3m", *library_));
    loop_.track_without_plan(robot, configuration_, *library_);
    loop_.attach(*hardware_, mail_);
  }

  [[nodiscard]] hal::EmulatedDriver& driver(std::size_t joint) {
    return hal::visit_driver(*emulators_[joint], [](auto& any) -> hal::EmulatedDriver& { return any; });
  }
  [[nodiscard]] hal::mock::MockBus& bus(std::size_t number) { return buses_[number]; }
  [[nodiscard]] supervisor::State state() const { return loop_.decision().state; }
  [[nodiscard]] const supervisor::SupervisorOutput& decision() const { return loop_.decision(); }
  /// The newest plan has one foot on the ground now.
  [[nodiscard]] bool in_single_support() {
    return control::interpolate(mail_.plans.newest(), loop_.time_s()).mode.count() == 1;
  }
  [[nodiscard]] const hal::JointReadings& readings() const { return readings_; }
  [[nodiscard]] const hal::BringUpProgress& bring_up() const { return bring_up_; }
  [[nodiscard]] bool all_enabled() {
    bool all = true;
    for (std::size_t i = 0; i < hal::kJoints; ++i) all = all && driver(i).enabled();
    return all;
  }
  [[nodiscard]] double largest_torque_Nm() {
    double largest = 0;
    for (std::size_t i = 0; i < hal::kJoints; ++i)
      largest = std::max(largest, std::abs(driver(i).torque_Nm()));
    return largest;
  }

  void ask(supervisor::RequestKind kind) { command_.request = {kind, command_.request.number + 1, 0}; }
  void press_emergency_stop(bool pressed) { pressed_ = pressed; }
  /// The process does not run for so long; the next tick is late by it.
  void sleep(std::int64_t duration_ns) {
    clock_.advance(duration_ns);
    wakeup_latency_ns_ = duration_ns;
  }

  void tick() {
    clock_.advance(kTick_ns);
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      driver(i).motor.position_rad += noise_rad();
      hal::FrameSink lost;
      if (gone_ && i / 2 == gone_bus_) driver(i).elapse(clock_.now_ns(), lost);
    }
    send_torso_frame();
    mail_.commands.writer() = command_;
    mail_.commands.publish();
    if (tick_ == due_ && fresh_) mail_.plans.publish();
    loop_.tick({.now_ns = clock_.now_ns(), .wakeup_latency_ns = wakeup_latency_ns_});
    wakeup_latency_ns_ = 0;
    hardware_->serve_restore([this](std::size_t number) { buses_[number].set_disconnected(gone_); });
    readings_ = mail_.telemetry.front()->joints;
    bring_up_ = mail_.telemetry.front()->bring_up;
    mail_.telemetry.pop();
    while (mail_.events.front() != nullptr) mail_.events.pop();
    if (planning && tick_ % 10 == 0 && supervisor::tracks(state())) {
      fresh_ = planner_.cycle(mail_.requests.newest(), mail_.plans.writer());
      due_ = tick_ + 5;
    }
    ++tick_;
  }
  /// Ticks until a state is reached, at most so many.
  bool reach(supervisor::State wanted, int ticks) {
    return run_until([&] { return state() == wanted; }, ticks);
  }
  /// Ticks until a level commands the joints, at most so many.
  bool reach(supervisor::FallbackLevel wanted, int ticks) {
    return run_until([&] { return decision().level == wanted; }, ticks);
  }
  template <class Condition>
  bool run_until(const Condition& holds, int ticks) {
    for (int i = 0; i < ticks && !holds(); ++i) tick();
    return holds();
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  /// A bus is gone, or can be connected again.
  void set_gone(std::size_t number, bool gone) {
    if (gone) buses_[number].set_disconnected(true);
    gone_bus_ = number;
    gone_ = gone;
  }

  /// A reset of joints that were damped, until it is taken or void. One before that may be void by then: a
  /// bus that is gone silences the emergency stop's channel, too.
  [[nodiscard]] bool reset() {
    const supervisor::SupervisorParameters& parameters = configuration_.supervisor;
    run(static_cast<int>(1000 * parameters.damped_before_off_s));
    ask(supervisor::RequestKind::reset);
    return reach(supervisor::State::idle, static_cast<int>(1000 * (parameters.reset_window_s + 0.1)));
  }
  /// A reset, and everything up to standing. False: something stands in the way.
  [[nodiscard]] bool recover() { return reset() && stand(); }
  [[nodiscard]] bool get_ready() {
    ask(supervisor::RequestKind::calibrate);
    return reach(supervisor::State::ready, 2000);
  }
  /// A reset is taken, and bring-up refused: offsets are void.
  [[nodiscard]] bool is_refused() {
    if (!reset()) return false;
    ask(supervisor::RequestKind::calibrate);
    return reach(supervisor::State::calibrate, 10) && reach(supervisor::State::fault, 10) &&
           bring_up_.failure == hal::bring_up::Failure::void_offsets;
  }
  [[nodiscard]] bool stand() {
    if (!get_ready()) return false;
    run(80);
    ask(supervisor::RequestKind::stand);
    if (!reach(supervisor::State::stand, 100)) return false;
    run(static_cast<int>(1000 * configuration_.supervisor.stand_ramp_s) + 100);
    return state() == supervisor::State::stand && decision().ramp == 1.0;
  }

  configuration::Configuration configuration_;
  bool planning = true;  ///< the planner makes plans

 private:
  /// Of a motor, from one tick to the next: a few counts. An AK of version 3 counts 1.7 mrad, every second
  /// tick.
  [[nodiscard]] double noise_rad() const {
    if (configuration_.hardware.hip.protocol != configuration::DriverProtocol::ak_v3)
      return tick_ % 2 == 0 ? 1e-3 : -1e-3;
    return tick_ % 3 == 0 ? 8e-3 : -4e-3;
  }

  /// As the shipped [torso_sensor] describes it: upright, at rest.
  void send_torso_frame() {
    hal::CanFrame frame = hal::classic_frame(0x150, 6);
    frame.data[0] = static_cast<std::uint8_t>(tick_ & 1);  // a micro-radian of noise
    frame.data[5] = pressed_ ? 0 : 1;
    buses_[0].script(frame, clock_.now_ns());
  }

  hal::mock::MockClock clock_;
  std::array<hal::mock::MockBus, 2> buses_;
  std::array<std::unique_ptr<hal::JointEmulator>, hal::kJoints> emulators_;
  std::unique_ptr<hal::RobotHardware> hardware_;
  Mailboxes mail_;
  PlannerTask planner_;
  ControlLoop loop_;
  std::unique_ptr<gait::GaitLibrary> library_ = std::make_unique<gait::GaitLibrary>();
  OperatorCommand command_;
  hal::JointReadings readings_;
  hal::BringUpProgress bring_up_;
  bool pressed_ = false;
  bool gone_ = false;
  std::size_t gone_bus_ = 0;
  bool fresh_ = false;
  std::int64_t wakeup_latency_ns_ = 0;
  long long tick_ = 0;
  long long due_ = -1;
};

}  // namespace stilt::control_loop::testing
