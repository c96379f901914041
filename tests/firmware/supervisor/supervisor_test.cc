#include "firmware/supervisor/supervisor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/firmware/supervisor/observations.h"

namespace stilt::supervisor {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A supervisor, its parameters, and the inputs of the next tick: healthy until a test spoils them.
class SupervisorTest : public ::testing::Test {
 protected:
  SupervisorTest() {
    inputs_.seen = testing::healthy();
    supervisor_.configure(testing::joint_limits(), parameters_);
    wanted_.fill({.position_rad = 0.3,
                  .velocity_rad_s = 0,
                  .torque_Nm = 30,
                  .kp_Nm_rad = 0,
                  .kd_Nms_rad = 0,
                  .torque_limit_Nm = 80});
  }

  State tick() {
    inputs_.seen.time_ns += testing::kTick_ns;
    supervisor_.update(inputs_);
    commands_.fill({});
    action_ = supervisor_.override(wanted_, commands_);
    return output().state;
  }
  State run(double duration_s) {
    for (double time_s = 0; time_s < duration_s - 1e-9; time_s += 1e-3) tick();
    return output().state;
  }
  void request(RequestKind kind, double speed_m_s = 0) {
    inputs_.request = {kind, inputs_.request.number + 1, speed_m_s};
  }
  void bring_to_ready() {
    tick();
    request(RequestKind::calibrate);
    tick();
    inputs_.bring_up_done = true;
    tick();
    run(0.1);
    ASSERT_EQ(output().state, State::ready);
  }
  /// As bring_to_ready(), then standing up is asked for in a pose that does not allow it.
  void ask_to_stand_where_it_cannot() {
    bring_to_ready();
    inputs_.fit_to_stand = false;
    request(RequestKind::stand);
    run(1.0);
  }
  void bring_to_stand() {
    bring_to_ready();
    request(RequestKind::stand);
    run(parameters_.stand_ramp_s + 0.01);
    ASSERT_EQ(output().state, State::stand);
  }
  void bring_to_walk() {
    bring_to_stand();
    request(RequestKind::walk, 0.5);
    tick();
    ASSERT_EQ(output().state, State::walk);
  }
  const SupervisorOutput& output() const { return supervisor_.output(); }

  /// All four commands only damp.
  bool only_damps() const {
    if (action_ != Action::commands) return false;
    for (const hal::JointCommand& command : commands_) {
      if (command.kp_Nm_rad != 0 || command.torque_Nm != 0 || command.velocity_rad_s != 0) return false;
      if (!(command.kd_Nms_rad >= 0)) return false;
    }
    return true;
  }

  SupervisorParameters parameters_;
  Supervisor supervisor_;
  SupervisorInputs inputs_;
  hal::JointCommands wanted_;
  hal::JointCommands commands_;
  Action action_ = Action::silent;
};

TEST_F(SupervisorTest, StandingUpWaitsForAPoseToStandUpFrom) {
  ask_to_stand_where_it_cannot();
  EXPECT_EQ(output().state, State::ready);
  EXPECT_TRUE(only_damps());
  inputs_.fit_to_stand = true;
  tick();
  EXPECT_EQ(output().state, State::stand);
}

TEST_F(SupervisorTest, FromBootToWalkingStepByStep) {
  EXPECT_EQ(output().state, State::boot);
  EXPECT_EQ(tick(), State::idle);
  EXPECT_EQ(action_, Action::silent);
  request(RequestKind::calibrate);
  EXPECT_EQ(tick(), State::calibrate);
  EXPECT_EQ(action_, Action::silent) << "the bring-up talks";
  EXPECT_EQ(run(0.5), State::calibrate);
  inputs_.bring_up_done = true;
  EXPECT_EQ(tick(), State::ready);
  EXPECT_TRUE(only_damps());
  request(RequestKind::stand);
  EXPECT_EQ(tick(), State::stand);
  EXPECT_TRUE(output().start_controller);
  request(RequestKind::walk, 0.5);
  EXPECT_EQ(run(parameters_.stand_ramp_s - 0.01), State::stand) << "not before the torque law took over";
  EXPECT_EQ(run(0.02), State::walk);
  EXPECT_EQ(output().gait.kind, gait::GaitKind::walk);
  EXPECT_EQ(output().gait.speed_m_s, 0.5);
  EXPECT_FALSE(output().start_controller);
}

TEST_F(SupervisorTest, TheTorqueLawTakesOverAlongARamp) {
  bring_to_ready();
  request(RequestKind::stand);
  double before_Nm = -1;
  for (int i = 0; i < 1500; ++i) {
    tick();
    EXPECT_GT(commands_[0].torque_Nm, before_Nm);
    EXPECT_LT(commands_[0].torque_Nm - before_Nm, 1.1);
    before_Nm = commands_[0].torque_Nm;
  }
  run(0.01);
  EXPECT_EQ(commands_[0].torque_Nm, 30);
  EXPECT_EQ(output().ramp, 1);
}

TEST_F(SupervisorTest, WalkingBecomesStandingOverSteppingInPlace) {
  bring_to_walk();
  request(RequestKind::stand);
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(output().gait.kind, gait::GaitKind::step);
  EXPECT_EQ(output().gait.speed_m_s, 0);
  EXPECT_EQ(run(parameters_.slow_down_s - 0.01), State::step);
  EXPECT_EQ(run(0.02), State::stand);
}

TEST_F(SupervisorTest, ALostHeartbeatStopsWalkingAndItsReturnDoesNotStartItAgain) {
  inputs_.seen.heartbeat_expected = true;
  bring_to_walk();
  inputs_.seen.heartbeat_age_s = 0.5;
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(output().rung, Rung::new_plan) << "and the plan is followed all along";
  EXPECT_EQ(run(parameters_.slow_down_s + 0.01), State::stand);
  EXPECT_TRUE(output().latched.empty());
  inputs_.seen.heartbeat_age_s = 0;
  EXPECT_EQ(run(1), State::stand);
  request(RequestKind::walk, 0.3);
  EXPECT_EQ(tick(), State::walk);
}

TEST_F(SupervisorTest, ALatchedFaultDampsUntilAResetWithTheCauseGone) {
  bring_to_walk();
  inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().raised.has(Fault::driver_fault));
  EXPECT_TRUE(only_damps());
  EXPECT_EQ(run(1), State::fault);
  EXPECT_FALSE(output().raised.has(Fault::driver_fault)) << "raised once";

  request(RequestKind::reset);
  EXPECT_EQ(run(2 * parameters_.reset_window_s), State::fault) << "the cause is there";
  inputs_.seen.joints[2].fault = hal::DriverFault::none;
  EXPECT_EQ(run(1), State::fault) << "a reset that came too early is void";
  for (const RequestKind kind :
       {RequestKind::stand, RequestKind::walk, RequestKind::step, RequestKind::sit, RequestKind::calibrate}) {
    request(kind, 0.5);
    EXPECT_EQ(run(0.1), State::fault);
    EXPECT_TRUE(only_damps());
  }
  request(RequestKind::reset);
  run(0.01);
  EXPECT_EQ(output().state, State::idle);
  EXPECT_TRUE(output().latched.empty());
}

TEST_F(SupervisorTest, AResetLetsGoOfTheDriversSoThatTheirOwnFaultsClear) {
  bring_to_walk();
  inputs_.seen.joints[2].fault = hal::DriverFault::lost_communication;
  run(0.1);
  request(RequestKind::reset);
  tick();
  EXPECT_EQ(action_, Action::disable);
  EXPECT_TRUE(output().clear_buses);
  inputs_.seen.joints[2].fault = hal::DriverFault::none;
  inputs_.seen.joints[2].state = hal::DriverState::idle;
  EXPECT_EQ(tick(), State::idle);
  EXPECT_FALSE(output().clear_buses);
}

TEST_F(SupervisorTest, NothingMovesByItselfAfterAReset) {
  bring_to_walk();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  EXPECT_EQ(tick(), State::fault);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle);
  EXPECT_EQ(run(5), State::idle);
}

TEST_F(SupervisorTest, ThreeMissedRepliesHoldThePoseAndTenDamp) {
  bring_to_walk();
  const double pose_rad = inputs_.seen.joints[0].position_rad;
  for (std::uint32_t missed = 1; missed <= 9; ++missed) {
    inputs_.seen.joints[1].missed = missed;
    EXPECT_EQ(tick(), State::walk);
    EXPECT_EQ(output().rung, missed < 3 ? Rung::new_plan : Rung::hold) << missed;
  }
  EXPECT_EQ(commands_[0].position_rad, pose_rad);
  EXPECT_GT(commands_[0].kp_Nm_rad, 0);
  EXPECT_EQ(commands_[0].torque_Nm, 0);
  inputs_.seen.joints[1].missed = 10;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, RepliesThatComeBackInTimeLetItWalkOn) {
  bring_to_walk();
  inputs_.seen.joints[1].missed = 5;
  tick();
  EXPECT_EQ(output().rung, Rung::hold);
  inputs_.seen.joints[1].missed = 0;
  EXPECT_EQ(tick(), State::walk);
  EXPECT_EQ(output().rung, Rung::new_plan);
  EXPECT_EQ(commands_[0].torque_Nm, 30);
}

TEST_F(SupervisorTest, AStalePlanSitsDownAndThenDamps) {
  bring_to_walk();
  inputs_.seen.plan_age_s = 0.1;
  EXPECT_EQ(tick(), State::walk);
  EXPECT_EQ(output().rung, Rung::older_plan);
  inputs_.seen.plan_age_s = 0.3;
  EXPECT_EQ(tick(), State::sit);
  EXPECT_EQ(output().rung, Rung::sit);
  EXPECT_NEAR(commands_[1].position_rad, inputs_.seen.joints[1].position_rad, 1e-9)
      << "from the measured pose";
  run(parameters_.sit_s - 0.005);
  EXPECT_EQ(output().state, State::sit);
  EXPECT_NEAR(commands_[0].position_rad, parameters_.sit_hip_rad, 1e-3);
  EXPECT_NEAR(commands_[1].position_rad, parameters_.sit_knee_rad, 1e-3);
  EXPECT_EQ(run(0.01), State::fault) << "latched";
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, StandingUpWaitsForTheFirstPlanWithoutAFault) {
  bring_to_ready();
  inputs_.seen.has_plan = false;
  request(RequestKind::stand);
  EXPECT_EQ(run(0.2), State::stand);
  EXPECT_EQ(output().rung, Rung::hold);
  EXPECT_EQ(run(0.1), State::sit) << "but not for ever";
}

TEST_F(SupervisorTest, ShuttingDownSitsDampsAndLetsGo) {
  bring_to_walk();
  inputs_.shut_down = true;
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(run(parameters_.slow_down_s), State::stand);
  EXPECT_EQ(run(parameters_.slow_down_s - 0.001), State::stand) << "the swing foot has to come down first";
  EXPECT_EQ(tick(), State::sit);
  EXPECT_EQ(run(parameters_.sit_s), State::ready);
  EXPECT_TRUE(only_damps());
  EXPECT_EQ(tick(), State::off);
  EXPECT_EQ(action_, Action::disable);
  EXPECT_EQ(run(1), State::off);
}

TEST_F(SupervisorTest, SwitchingOffWhileWalkingSitsDownFirst) {
  bring_to_walk();
  request(RequestKind::off);
  EXPECT_EQ(run(2 * parameters_.slow_down_s + 0.1), State::sit);
  EXPECT_EQ(run(parameters_.sit_s), State::off);
}

TEST_F(SupervisorTest, CommandsThatAreNotFiniteNeverLeave) {
  bring_to_walk();
  wanted_[3].torque_Nm = kNan;
  tick();
  EXPECT_TRUE(only_damps()) << "in the very tick";
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().latched.has(Fault::not_finite));
}

TEST_F(SupervisorTest, TorquesNeverExceedTheJoint) {
  bring_to_walk();
  wanted_[0].torque_Nm = 1e6;
  wanted_[1].torque_Nm = -1e6;
  tick();
  EXPECT_EQ(commands_[0].torque_Nm, 80);
  EXPECT_EQ(commands_[1].torque_Nm, -80);
}

TEST_F(SupervisorTest, BootWaitsForTheEmergencyStopAndThenTreatsSilenceAsPressed) {
  inputs_.seen.emergency_stop = hal::EmergencyStopState::unknown;
  EXPECT_EQ(run(parameters_.emergency_stop_wait_s - 0.01), State::boot);
  EXPECT_EQ(run(0.05), State::fault);
  EXPECT_TRUE(output().latched.has(Fault::emergency_stop));
}

TEST_F(SupervisorTest, IdleDoesNotCareForDriversThatAreNotDriven) {
  for (hal::JointReading& joint : inputs_.seen.joints) {
    joint = hal::JointReading{};
    joint.missed = 5000;
  }
  inputs_.seen.base.missed = 5000;
  EXPECT_EQ(run(1), State::idle);
}

TEST_F(SupervisorTest, AFailedBringUpLetsGoOfTheDrivers) {
  tick();
  request(RequestKind::calibrate);
  tick();
  inputs_.seen.bring_up_failed = true;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_EQ(output().rung, Rung::off);
  EXPECT_EQ(action_, Action::disable);
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle);
}

TEST_F(SupervisorTest, EveryLatchingFaultEndsInFaultWithoutAWayBack) {
  struct Spoil {
    Fault fault;
    std::function<void(Observation&)> how;
  };
  const Spoil spoils[] = {
      {Fault::joint_position_limit, [](Observation& o) { o.joints[0].position_rad = 3; }},
      {Fault::joint_speed_limit, [](Observation& o) { o.joints[0].velocity_rad_s = 40; }},
      {Fault::joint_torque_limit, [](Observation& o) { o.joints[0].torque_Nm = 140; }},
      {Fault::base_angle_limit, [](Observation& o) { o.base.pitch_rad = 1; }},
      {Fault::stale_encoder,
       [](Observation& o) {
         o.joints[0].frozen = 100;
         o.planned_speed_rad_s[0] = 2;
       }},
      {Fault::stale_base_sensor, [](Observation& o) { o.base.missed = 20; }},
      {Fault::lost_replies, [](Observation& o) { o.joints[0].missed = 20; }},
      {Fault::bus_off, [](Observation& o) { o.read_status = hal::JointBusStatus::bus_off; }},
      {Fault::bus_disconnected, [](Observation& o) { o.read_status = hal::JointBusStatus::disconnected; }},
      {Fault::driver_fault, [](Observation& o) { o.joints[0].fault = hal::DriverFault::encoder; }},
      {Fault::driver_not_enabled, [](Observation& o) { o.joints[0].state = hal::DriverState::idle; }},
      {Fault::driver_overheated, [](Observation& o) { o.joints[0].motor_temperature_C = 120; }},
      {Fault::low_voltage, [](Observation& o) { o.joints[0].supply_V = 15; }},
      {Fault::high_voltage, [](Observation& o) { o.joints[0].supply_V = 70; }},
      {Fault::stale_plan, [](Observation& o) { o.plan_age_s = 1; }},
      {Fault::torque_loop_stalled, [](Observation& o) { o.lateness_s = 0.02; }},
      {Fault::not_finite, [](Observation& o) { o.controller_finite = false; }},
      {Fault::emergency_stop, [](Observation& o) { o.emergency_stop = hal::EmergencyStopState::pressed; }},
  };
  FaultSet tried;
  for (const Spoil& spoil : spoils) {
    SCOPED_TRACE(name(spoil.fault));
    tried.add(spoil.fault);
    supervisor_.configure(testing::joint_limits(), parameters_);
    inputs_ = {};
    inputs_.seen = testing::healthy();
    bring_to_walk();
    run(0.3);
    spoil.how(inputs_.seen);
    const State first = tick();
    const bool sits = row(spoil.fault).reaction == Reaction::sit;
    EXPECT_EQ(first, sits ? State::sit : State::fault);
    EXPECT_EQ(output().reaction, row(spoil.fault).reaction);
    EXPECT_TRUE(output().latched.has(spoil.fault));
    EXPECT_EQ(run(parameters_.sit_s + 0.1), State::fault);
    const std::int64_t time_ns = inputs_.seen.time_ns;
    inputs_.seen = testing::healthy();
    inputs_.seen.time_ns = time_ns;
    EXPECT_EQ(run(1), State::fault) << "the cause alone going away is not enough";
    EXPECT_TRUE(only_damps());
  }
  tried.add(Fault::bring_up_failed);  // in calibrate only, see above
  EXPECT_EQ(tried, of_severity(Severity::latched));
}

/// Whatever comes in, in whatever order: no torque without a state for it, no fault without its reaction.
TEST_F(SupervisorTest, RandomInputsNeverBreakTheRules) {
  constexpr unsigned kSeed = 20;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> thing(0, 400);
  std::uniform_int_distribution<int> kind(0, static_cast<int>(RequestKind::reset));
  State before = State::boot;
  for (int i = 0; i < 300'000; ++i) {
    const int chance = thing(random);
    if (chance == 0) request(static_cast<RequestKind>(kind(random)), 0.5);
    if (chance == 1) inputs_.seen.joints[0].missed = 12;
    if (chance == 2) inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
    if (chance == 3) inputs_.seen.base.pitch_rad = kNan;
    if (chance == 4) wanted_[2].torque_Nm = kNan;
    if (chance == 5) inputs_.seen.plan_age_s = 0.3;
    if (chance >= 6 && chance < 20) {
      const std::int64_t time_ns = inputs_.seen.time_ns;
      inputs_.seen = testing::healthy();
      inputs_.seen.time_ns = time_ns;
      wanted_[2].torque_Nm = 30;
    }
    inputs_.bring_up_done = chance < 100;
    const State state = tick();
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", tick " << i << ", " << name(state));
    ASSERT_TRUE(state != State::fault || only_damps() || action_ == Action::disable);
    ASSERT_TRUE(has_torque(state) || action_ != Action::commands || only_damps());
    ASSERT_TRUE(before != State::fault || state == State::fault || state == State::idle);
    ASSERT_TRUE(!has_torque(state) || has_torque(before) || before == State::ready);
    ASSERT_TRUE(!tracks(state) || output().reaction < Reaction::sit);
    ASSERT_LE(std::abs(commands_[2].torque_Nm), 80);
    before = state;
  }
}

}  // namespace
}  // namespace stilt::supervisor
