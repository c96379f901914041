// Requests that are met, given up or come too late: nothing moves again by itself.
#include <gtest/gtest.h>

#include "tests/firmware/supervisor/supervisor_rig.h"

namespace stilt::supervisor {
namespace {

using testing::SupervisorTest;

TEST_F(SupervisorTest, AStandThatWasGivenUpBeginsNotByItselfWhateverWasAskedForMeanwhile) {
  for (const RequestKind meanwhile : {RequestKind::stand, RequestKind::step, RequestKind::walk}) {
    for (const bool in_the_same_tick : {false, true}) {
      power_on();
      bring_to_ready();
      request(RequestKind::stand);
      run(0.3);
      ASSERT_EQ(output().state, State::stand);
      request(meanwhile);
      if (!in_the_same_tick) run(0.1);
      inputs_.in_stance = false;
      EXPECT_EQ(tick(), State::ready);
      inputs_.in_stance = true;
      EXPECT_EQ(run(3), State::ready) << static_cast<int>(meanwhile) << in_the_same_tick;
      request(RequestKind::stand);
      EXPECT_EQ(tick(), State::stand);
    }
  }
}

TEST_F(SupervisorTest, AStandThatWasGivenUpLeavesSwitchingOff) {
  bring_to_ready();
  request(RequestKind::stand);
  run(0.3);
  request(RequestKind::off);
  inputs_.in_stance = false;
  EXPECT_EQ(tick(), State::ready);
  EXPECT_EQ(run(parameters_.damped_before_off_s - 0.001), State::ready) << "the joints are damped first";
  EXPECT_EQ(tick(), State::off);
}

TEST_F(SupervisorTest, NothingStandsUpWhileTheProgramEnds) {
  ask_to_stand_where_it_cannot();
  inputs_.shut_down = true;
  inputs_.fit_to_stand = true;
  EXPECT_EQ(run(0.5), State::ready);
  EXPECT_FALSE(output().waits_to_stand);
  request(RequestKind::stand);
  EXPECT_EQ(run(0.5), State::ready);
  EXPECT_EQ(run(parameters_.damped_before_off_s), State::off);
}

TEST_F(SupervisorTest, NothingStandsUpAfterItsCommanderFellSilent) {
  inputs_.seen.heartbeat_expected = true;
  ask_to_stand_where_it_cannot();
  EXPECT_TRUE(output().waits_to_stand);
  inputs_.seen.heartbeat_age_s = 0.5;
  tick();
  EXPECT_TRUE(output().stand_void);
  EXPECT_FALSE(output().waits_to_stand);
  inputs_.fit_to_stand = true;
  EXPECT_EQ(run(1.0), State::ready);
  inputs_.seen.heartbeat_age_s = 0;
  EXPECT_EQ(run(1.0), State::ready) << "nor when one is back";
  request(RequestKind::stand);
  EXPECT_EQ(tick(), State::stand);
}

TEST_F(SupervisorTest, AStepThatWasAskedForTwiceIsMetOnce) {
  bring_to_stand();
  for (int times = 0; times < 2; ++times) {
    request(RequestKind::step);
    ASSERT_EQ(run(0.1), State::step);
  }
  inputs_.shut_down = true;
  EXPECT_EQ(run(parameters_.slow_down_s), State::stand);
  EXPECT_EQ(run(parameters_.slow_down_s), State::sit);
}

TEST_F(SupervisorTest, NothingStepsOrWalksWhileTheProgramEnds) {
  bring_to_walk();
  inputs_.shut_down = true;
  const double longest_s =
      2 * parameters_.slow_down_s + parameters_.sit_s + parameters_.damped_before_off_s + 0.1;
  for (double time_s = 0; time_s < longest_s; time_s += 0.1) {
    request(static_cast<int>(time_s * 10) % 2 == 0 ? RequestKind::walk : RequestKind::step, 0.5);
    EXPECT_NE(run(0.1), State::walk) << time_s;
  }
  EXPECT_EQ(run(0.1), State::off);
}

TEST_F(SupervisorTest, AnEmergencyStopInTheStateFaultIsDampedAsLongAsInAnyOther) {
  bring_to_walk();
  inputs_.seen.joints[2].fault = hal::DriverFault::over_current;
  ASSERT_EQ(tick(), State::fault);
  run(2 * parameters_.damped_before_off_s);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  run(parameters_.damped_before_off_s - 0.1);
  EXPECT_TRUE(only_damps());
  run(0.2);
  EXPECT_EQ(action_, Action::disable);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::released;
  run(0.1);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  run(0.1);
  EXPECT_EQ(action_, Action::disable) << "the motors stay off until a reset";
}

}  // namespace
}  // namespace stilt::supervisor
