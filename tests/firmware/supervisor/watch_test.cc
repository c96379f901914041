// In which states each fault is looked for, what it asks for, and when requests made before it are void.
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

#include "tests/firmware/supervisor/spoils.h"
#include "tests/firmware/supervisor/supervisor_rig.h"

namespace stilt::supervisor {
namespace {

using testing::kSpoils;
using testing::Spoil;
using testing::SupervisorTest;

/// What is expected of a fault, written down apart from the table.
struct Expected {
  Severity severity;
  Reaction reaction;
  Watch watch;
};

Expected expected(Fault fault) {
  switch (fault) {
    case Fault::bus_off:
    case Fault::bus_disconnected:
    case Fault::emergency_stop:
      return {Severity::latched, Reaction::damp, Watch::always};
    case Fault::torque_loop_overrun:
      return {Severity::warning, Reaction::warn, Watch::always};
    case Fault::bring_up_failed:
      return {Severity::latched, Reaction::off, Watch::bring_up};
    case Fault::joint_position_limit:
    case Fault::joint_speed_limit:
    case Fault::joint_torque_limit:
    case Fault::stale_torso_sensor:
    case Fault::lost_replies:
    case Fault::driver_fault:
    case Fault::driver_not_enabled:
    case Fault::high_voltage:
    case Fault::torque_loop_stalled:
      return {Severity::latched, Reaction::damp, Watch::driven};
    case Fault::driver_overheated:
    case Fault::low_voltage:
      return {Severity::latched, Reaction::sit, Watch::driven};
    case Fault::missed_replies:
      return {Severity::degraded, Reaction::hold, Watch::driven};
    case Fault::bus_error:
    case Fault::driver_hot:
      return {Severity::warning, Reaction::warn, Watch::driven};
    case Fault::following_error:
    case Fault::encoder_jump:
    case Fault::torque_mismatch:
    case Fault::base_pitch_limit:
      return {Severity::latched, Reaction::damp, Watch::torque};
    case Fault::encoder_frozen:
    case Fault::hip_height_limit:
    case Fault::torso_sensor_implausible:
    case Fault::not_finite:
      return {Severity::latched, Reaction::damp, Watch::tracking};
    case Fault::stale_plan:
    case Fault::planner_lost:
    case Fault::operator_gone:
      return {Severity::latched, Reaction::sit, Watch::tracking};
    case Fault::heartbeat_lost:
      return {Severity::degraded, Reaction::slow, Watch::tracking};
    case Fault::failed_solves:
    case Fault::planner_overrun:
    case Fault::plan_missing:
      return {Severity::warning, Reaction::warn, Watch::tracking};
  }
  return {};
}

bool looked_for(Watch watch, State state) {
  const auto among = [state](std::initializer_list<State> states) {
    return std::find(states.begin(), states.end(), state) != states.end();
  };
  switch (watch) {
    case Watch::always:
      return !among({State::boot, State::off});
    case Watch::bring_up:
      return state == State::calibrate;
    case Watch::driven:
      return among({State::ready, State::stand, State::step, State::walk, State::sit, State::fault});
    case Watch::torque:
      return among({State::stand, State::step, State::walk, State::sit});
    case Watch::tracking:
      return among({State::stand, State::step, State::walk});
  }
  return false;
}

class WatchTest : public SupervisorTest {
 protected:
  /// From power-on, with nothing out of order at the end.
  void bring_to(State state) {
    power_on();
    switch (state) {
      case State::boot:
        inputs_.seen.emergency_stop = hal::EmergencyStopState::unknown;
        break;
      case State::idle:
        tick();
        break;
      case State::calibrate:
        tick();
        request(RequestKind::calibrate);
        tick();
        break;
      case State::ready:
        bring_to_ready();
        break;
      case State::stand:
        bring_to_stand();
        break;
      case State::step:
        bring_to_stand();
        request(RequestKind::step);
        tick();
        break;
      case State::walk:
        bring_to_walk();
        break;
      case State::sit:
        bring_to_stand();
        request(RequestKind::sit);
        tick();
        break;
      case State::fault:
        bring_to_stand();
        inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
        tick();
        inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
        tick();
        break;
      case State::off:
        tick();
        inputs_.shut_down = true;
        tick();
        break;
      case State::watch:
        FAIL() << "the supervisor is never there";
    }
    ASSERT_EQ(output().state, state);
    ASSERT_TRUE(output().present.empty());
  }
};

TEST_F(WatchTest, EveryFaultIsLookedForInItsStatesAndInNoOther) {
  for (const Spoil& spoil : kSpoils) {
    for (int i = 0; i < static_cast<int>(kStates); ++i) {
      const auto state = static_cast<State>(i);
      if (state == State::watch) continue;
      SCOPED_TRACE(::testing::Message() << name(spoil.fault) << " in " << name(state));
      bring_to(state);
      spoil.apply(inputs_.seen);
      tick();
      EXPECT_EQ(output().present.has(spoil.fault), looked_for(expected(spoil.fault).watch, state));
    }
  }
}

TEST_F(WatchTest, AJointThatIsSpoiledWhileTheRobotSitsDownIsDamped) {
  for (const Fault fault :
       {Fault::driver_not_enabled, Fault::following_error, Fault::encoder_jump, Fault::torque_mismatch}) {
    SCOPED_TRACE(name(fault));
    bring_to(State::sit);
    kSpoils[static_cast<std::size_t>(fault)].apply(inputs_.seen);
    EXPECT_EQ(tick(), State::fault);
    EXPECT_TRUE(output().latched.has(fault));
    EXPECT_TRUE(only_damps());
  }
}

TEST_F(WatchTest, EveryFaultAsksForItsReactionAndLatchesOrNot) {
  for (const Spoil& spoil : kSpoils) {
    SCOPED_TRACE(name(spoil.fault));
    const Expected wanted = expected(spoil.fault);
    bring_to(wanted.watch == Watch::bring_up ? State::calibrate : State::stand);
    spoil.apply(inputs_.seen);
    tick();
    EXPECT_EQ(output().raised.has(spoil.fault), true);
    EXPECT_EQ(output().latched.has(spoil.fault), wanted.severity == Severity::latched);
    EXPECT_EQ(row(spoil.fault).severity, wanted.severity);
    EXPECT_EQ(row(spoil.fault).reaction, wanted.reaction);
    EXPECT_GE(output().reaction, wanted.reaction);
  }
}

/// Drivers that have just come up need a moment until everything has replied.
class SettlingTest : public SupervisorTest {
 protected:
  /// In the tick after the drivers came up, with standing up asked for and the fault's cause there.
  void spoil_drivers_that_just_came_up(Fault fault) {
    power_on();
    tick();
    request(RequestKind::calibrate);
    tick();
    inputs_.bring_up_done = true;
    tick();
    ASSERT_EQ(output().state, State::ready);
    kSpoils[static_cast<std::size_t>(fault)].apply(inputs_.seen);
    request(RequestKind::stand);
  }
};

TEST_F(SettlingTest, FaultsOfRepliesCountFromTheSettlingTimeOn) {
  for (const Fault fault : {Fault::stale_torso_sensor, Fault::driver_not_enabled, Fault::driver_fault}) {
    SCOPED_TRACE(name(fault));
    spoil_drivers_that_just_came_up(fault);
    run(parameters_.settle_s - 0.001);
    EXPECT_FALSE(output().present.has(fault)) << "a tick before";
    EXPECT_EQ(output().state, State::stand);
    run(0.002);
    EXPECT_TRUE((output().present | output().latched).has(fault)) << "a tick after";
  }
}

TEST_F(SettlingTest, AllOtherFaultsCountAtOnce) {
  for (const Fault fault : {Fault::joint_position_limit, Fault::joint_speed_limit, Fault::joint_torque_limit,
                            Fault::low_voltage, Fault::high_voltage, Fault::driver_overheated,
                            Fault::torque_loop_stalled, Fault::bus_off, Fault::lost_replies}) {
    SCOPED_TRACE(name(fault));
    spoil_drivers_that_just_came_up(fault);
    tick();
    EXPECT_TRUE(output().present.has(fault));
    EXPECT_EQ(output().state, State::fault);
  }
}

TEST_F(SupervisorTest, AWalkAskedForWhileItStandsUpIsVoidAfterALostHeartbeat) {
  inputs_.seen.heartbeat_expected = true;
  bring_to_ready();
  request(RequestKind::stand);
  run(0.1);
  request(RequestKind::walk, 0.5);
  run(0.1);
  inputs_.seen.heartbeat_age_s = 0.5;
  tick();
  inputs_.seen.heartbeat_age_s = 0;
  EXPECT_EQ(run(parameters_.stand_ramp_s + 0.5), State::stand);
  request(RequestKind::walk, 0.5);
  EXPECT_EQ(tick(), State::walk) << "asked for again";
}

TEST_F(SupervisorTest, AResetAskedForBeforeAFaultDoesNotResetIt) {
  bring_to_stand();
  request(RequestKind::reset);
  run(0.01);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  EXPECT_EQ(tick(), State::fault);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  EXPECT_EQ(run(parameters_.damped_before_off_s + 1), State::fault);
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle) << "asked for again";
}

TEST_F(SupervisorTest, AResetDampsUntilTheFaultIsOverAndThenDisables) {
  bring_to_stand();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  tick();
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  request(RequestKind::reset);
  EXPECT_EQ(run(parameters_.damped_before_off_s - 0.001), State::fault);
  EXPECT_FALSE(output().clear_buses) << "the robot may still fall";
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(only_damps());
  EXPECT_TRUE(output().clear_buses);
  EXPECT_EQ(tick(), State::idle);
  for (int ticks = 0; ticks < 5; ++ticks, tick()) {
    EXPECT_EQ(action_, Action::disable)
        << "idle leaves no driver enabled, though a bus withholds a frame: " << ticks;
  }
}

}  // namespace
}  // namespace stilt::supervisor
