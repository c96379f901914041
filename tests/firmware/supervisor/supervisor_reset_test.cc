// How the motors go off, and what a reset brings back.
#include <gtest/gtest.h>

#include "tests/firmware/supervisor/supervisor_rig.h"

namespace stilt::supervisor {
namespace {

using testing::SupervisorTest;

TEST_F(SupervisorTest, ACutTurnsTheMotorsOffInTheNextTickFromAnyState) {
  const auto bring_to = [this](State state) {
    power_on();
    if (state == State::boot) return;
    tick();
    if (state == State::idle) return;
    if (state == State::ready) return bring_to_ready();
    if (state == State::stand) return bring_to_stand();
    if (state == State::calibrate) {
      request(RequestKind::calibrate);
      tick();
      return;
    }
    if (state == State::sit) {
      bring_to_stand();
      request(RequestKind::sit);
      run(0.1);
      return;
    }
    bring_to_walk();
    if (state == State::step) request(RequestKind::step);
    if (state == State::fault) inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
    tick();
  };
  for (std::size_t number = 0; number < kStates; ++number) {
    const auto from = static_cast<State>(number);
    if (from == State::off || from == State::watch) continue;
    SCOPED_TRACE(name(from));
    bring_to(from);
    ASSERT_EQ(output().state, from);
    request(RequestKind::cut);
    EXPECT_EQ(tick(), State::off);
    EXPECT_EQ(action_, Action::disable);
  }
}

TEST_F(SupervisorTest, ACutIsNotVoidAfterAFault) {
  bring_to_walk();
  request(RequestKind::cut);
  inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
  EXPECT_EQ(tick(), State::off);
  EXPECT_EQ(action_, Action::disable);
}

TEST_F(SupervisorTest, AfterAnEmergencyStopItSettlesAndThenTheMotorsAreOff) {
  bring_to_walk();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_EQ(run(parameters_.damped_before_off_s - 0.1), State::fault);
  EXPECT_TRUE(only_damps());
  EXPECT_EQ(run(0.2), State::fault);
  EXPECT_EQ(action_, Action::disable);
  request(RequestKind::reset);
  for (double time_s = 0; time_s < 2 * parameters_.reset_window_s; time_s += 1e-3) {
    ASSERT_EQ(tick(), State::fault);
    ASSERT_EQ(action_, Action::disable) << "a reset while it is pressed energises nothing: " << time_s;
  }
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  EXPECT_EQ(run(1), State::fault) << "not by itself";
  EXPECT_EQ(action_, Action::disable);
  request(RequestKind::reset);
  EXPECT_EQ(run(0.1), State::idle);
}

TEST_F(SupervisorTest, ALatchedFaultDampsUntilAResetWithTheCauseGone) {
  bring_to_walk();
  inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().raised.has(Fault::driver_fault));
  EXPECT_TRUE(only_damps());
  EXPECT_EQ(run(parameters_.damped_before_off_s), State::fault);
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

TEST_F(SupervisorTest, AnIdleDriverIsReportedWhileTheOthersAreDampedAndKeepsNoResetWaiting) {
  bring_to_walk();
  inputs_.seen.joints[2].state = hal::DriverState::idle;
  ASSERT_EQ(tick(), State::fault);
  for (double time_s = 0; time_s < parameters_.damped_before_off_s + 0.1; time_s += 1e-3) {
    tick();
    ASSERT_TRUE(output().present.has(Fault::driver_not_enabled)) << "its joint is limp: " << time_s;
    ASSERT_TRUE(only_damps());
  }
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle);
  EXPECT_TRUE(output().latched.empty());
}

TEST_F(SupervisorTest, DriversThatComeBackIdleAfterALossOfPowerAreReportedInTheFault) {
  bring_to_walk();
  for (hal::JointReading& joint : inputs_.seen.joints) joint.missed_replies = 20;
  ASSERT_EQ(tick(), State::fault);
  EXPECT_FALSE(output().latched.has(Fault::driver_not_enabled));
  for (hal::JointReading& joint : inputs_.seen.joints) {
    joint.missed_replies = 0;
    joint.state = hal::DriverState::idle;
  }
  tick();
  EXPECT_TRUE(output().ended.has(Fault::lost_replies));
  EXPECT_TRUE(output().raised.has(Fault::driver_not_enabled));
}

TEST_F(SupervisorTest, DriversAreRightlyIdleOnceTheMotorsAreOff) {
  bring_to_walk();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  run(parameters_.damped_before_off_s + 0.1);
  ASSERT_EQ(action_, Action::disable);
  for (hal::JointReading& joint : inputs_.seen.joints) joint.state = hal::DriverState::idle;
  inputs_.seen.joints[1].missed_replies = 5000;
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  run(0.1);
  request(RequestKind::reset);
  tick();
  ASSERT_TRUE(only_damps()) << "those that are still enabled";
  for (double time_s = 0; time_s < 2 * parameters_.reset_window_s; time_s += 1e-3) {
    ASSERT_EQ(tick(), State::fault) << "one is silent";
    ASSERT_FALSE(output().latched.has(Fault::driver_not_enabled)) << time_s;
  }
  inputs_.seen.joints[1].missed_replies = 0;
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle);
}

TEST_F(SupervisorTest, ARejectedResetDampsAllAlong) {
  bring_to_walk();
  inputs_.seen.joints[2].motor_temperature_C = 20;
  inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
  run(parameters_.damped_before_off_s);
  request(RequestKind::reset);
  for (double time_s = 0; time_s < 2 * parameters_.reset_window_s; time_s += 1e-3) {
    ASSERT_EQ(tick(), State::fault);
    ASSERT_TRUE(only_damps()) << time_s;
  }
}

TEST_F(SupervisorTest, AResetGoesOnThroughTheFaultsThatDriversReportWhenTheirBusIsBack) {
  bring_to_walk();
  inputs_.seen.read_status = hal::JointBusStatus::bus_off;
  run(parameters_.damped_before_off_s + 0.1);
  request(RequestKind::reset);
  tick();
  inputs_.seen.read_status = hal::JointBusStatus::ok;
  inputs_.seen.joints[1].fault = hal::DriverFault::lost_communication;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().clear_buses);
  inputs_.seen.joints[1].fault = hal::DriverFault::none;
  EXPECT_EQ(run(0.01), State::idle);
}

TEST_F(SupervisorTest, AFaultBeforeTheDriversWereUpSendsNothing) {
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  for (int i = 0; i < 1000; ++i) {
    tick();
    ASSERT_EQ(action_, Action::silent) << "the button is pressed at the start: " << name(output().state);
  }
  EXPECT_EQ(output().state, State::fault);
  EXPECT_EQ(output().level, FallbackLevel::off);
  for (hal::JointReading& joint : inputs_.seen.joints) joint.missed_replies = 5000;
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle) << "drivers without commands do not answer";
  EXPECT_EQ(action_, Action::silent);
}

TEST_F(SupervisorTest, AFaultDuringBringUpDisables) {
  tick();
  request(RequestKind::calibrate);
  tick();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(tick(), State::fault);
    ASSERT_EQ(action_, Action::disable) << "some may be enabled already";
  }
}

/// Their answers show that they have their power.
TEST_F(SupervisorTest, DriversThatWereUpAreKeptOffInIdleAndThroughAFaultThere) {
  bring_to_ready();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  tick();
  EXPECT_TRUE(only_damps());
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  request(RequestKind::reset);
  ASSERT_EQ(run(10), State::idle);
  EXPECT_EQ(action_, Action::disable);
  for (int times = 0; times < 2; ++times) {
    inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
    EXPECT_EQ(run(0.1), State::fault);
    EXPECT_EQ(action_, Action::disable);
    inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
    request(RequestKind::reset);
    EXPECT_EQ(run(0.1), State::idle);
    EXPECT_EQ(action_, Action::disable);
  }
}

TEST_F(SupervisorTest, NothingMovesByItselfAfterAReset) {
  bring_to_walk();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  EXPECT_EQ(tick(), State::fault);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  request(RequestKind::reset);
  EXPECT_EQ(run(parameters_.damped_before_off_s + 0.01), State::idle);
  EXPECT_EQ(run(5), State::idle);
}

TEST_F(SupervisorTest, AResetAfterAnEmergencyStopDampsWhileItLooksForOtherCauses) {
  bring_to_walk();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  run(parameters_.damped_before_off_s + 0.1);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  inputs_.seen.joints[1].missed_replies = 5000;  // silent without its power
  run(0.1);
  EXPECT_EQ(action_, Action::disable);
  request(RequestKind::reset);
  run(parameters_.reset_window_s / 2);
  EXPECT_TRUE(only_damps());
  inputs_.seen.joints[1].missed_replies = 0;
  EXPECT_EQ(tick(), State::idle);
}

TEST_F(SupervisorTest, ARobotThatFallsIsDampedBeforeAStopOrAResetTakesItsTorque) {
  for (const RequestKind kind : {RequestKind::none, RequestKind::off, RequestKind::reset}) {
    SCOPED_TRACE(static_cast<int>(kind));
    power_on();
    bring_to_walk();
    inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
    ASSERT_EQ(tick(), State::fault);
    inputs_.seen.joints[2].fault = hal::DriverFault::none;
    inputs_.shut_down = kind == RequestKind::none;
    if (kind != RequestKind::none) request(kind);
    for (double time_s = 0; time_s < parameters_.damped_before_off_s - 0.0015; time_s += 1e-3) {
      ASSERT_EQ(tick(), State::fault) << time_s;
      ASSERT_TRUE(only_damps()) << time_s;
    }
    EXPECT_EQ(run(0.002), kind == RequestKind::reset ? State::idle : State::off) << "it was not lost";
    EXPECT_EQ(action_, Action::disable);
  }
}

TEST_F(SupervisorTest, ARobotThatHasBeenDampedGoesOffAndIsResetAtOnce) {
  bring_to_ready();
  run(parameters_.damped_before_off_s);
  request(RequestKind::off);
  EXPECT_EQ(tick(), State::off);

  for (const RequestKind kind : {RequestKind::off, RequestKind::reset}) {
    power_on();
    bring_to_ready();
    run(parameters_.damped_before_off_s);
    inputs_.seen.joints[0].supply_V = 30;
    ASSERT_EQ(tick(), State::fault);
    inputs_.seen.joints[0].supply_V = 48;
    request(kind);
    EXPECT_EQ(run(0.002), kind == RequestKind::off ? State::off : State::idle) << "damped in ready already";
  }
}

TEST_F(SupervisorTest, AFaultWhoseMotorsAreOffWaitsForNothing) {
  for (const RequestKind kind : {RequestKind::off, RequestKind::reset}) {
    power_on();
    tick();
    request(RequestKind::calibrate);
    tick();
    inputs_.seen.bring_up_failed = true;
    ASSERT_EQ(tick(), State::fault);
    ASSERT_EQ(action_, Action::disable);
    request(kind);
    EXPECT_EQ(run(0.002), kind == RequestKind::off ? State::off : State::idle);
  }
}

TEST_F(SupervisorTest, NoFurtherFaultKeepsADampedRobotFromGoingOff) {
  for (const bool in_ready : {false, true}) {
    power_on();
    in_ready ? bring_to_ready() : bring_to_walk();
    if (!in_ready) inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
    tick();
    request(RequestKind::off);
    run(0.1);
    inputs_.seen.joints[0].torque_Nm = 500;  // of the ground
    ASSERT_EQ(tick(), State::fault);
    inputs_.seen.joints[0].torque_Nm = 5;
    EXPECT_EQ(run(parameters_.damped_before_off_s), State::off) << in_ready;
  }
}

}  // namespace
}  // namespace stilt::supervisor
