#include "firmware/supervisor/supervisor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/firmware/supervisor/supervisor_rig.h"

namespace stilt::supervisor {
namespace {

using testing::joint_limits;
using testing::SupervisorTest;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
  EXPECT_EQ(action_, Action::silent) << "only the bring-up sends";
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
  const double start_rad = inputs_.seen.joints[0].position_rad;
  request(RequestKind::stand);
  double before_Nm = -1;
  for (int i = 0; i < 1500; ++i) {
    tick();
    inputs_.seen.joints[0].position_rad += 1e-5;  // the ramp keeps the pose in which it began
    const double expected_rad = start_rad + output().ramp * (wanted_[0].position_rad - start_rad);
    EXPECT_NEAR(commands_[0].position_rad, expected_rad, 1e-12);
    EXPECT_GT(commands_[0].torque_Nm, before_Nm);
    EXPECT_LT(commands_[0].torque_Nm - before_Nm, 1.1);
    before_Nm = commands_[0].torque_Nm;
  }
  run(0.01);
  EXPECT_EQ(commands_[0].torque_Nm, 30);
  EXPECT_EQ(output().ramp, 1);
}

TEST_F(SupervisorTest, AWalkAtASpeedThatIsNotANumberStepsInPlace) {
  bring_to_walk();
  for (const double speed_m_s : {kNan, HUGE_VAL, -HUGE_VAL}) {
    request(RequestKind::walk, speed_m_s);
    EXPECT_EQ(run(0.01), State::walk);
    EXPECT_EQ(output().gait.speed_m_s, 0);
  }
  request(RequestKind::walk, -0.4);
  tick();
  EXPECT_EQ(output().gait.speed_m_s, -0.4);
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

TEST_F(SupervisorTest, StandingUpWaitsForTheFirstPlanWithoutAFault) {
  bring_to_ready();
  inputs_.seen.followable.plan = PlanUse::none;
  request(RequestKind::stand);
  EXPECT_EQ(run(0.2), State::stand);
  EXPECT_EQ(output().level, FallbackLevel::hold);
  for (double time_s = 0; time_s < 0.1; time_s += 1e-3) {
    ASSERT_NE(tick(), State::sit) << "its legs have not carried it yet";
  }
  EXPECT_EQ(output().state, State::fault) << "but not for ever";
  EXPECT_TRUE(output().latched.has(Fault::stale_plan));
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, AStopAtTheBeginningOfStandingUpEndsItDamped) {
  for (const RequestKind kind : {RequestKind::sit, RequestKind::off, RequestKind::none}) {
    power_on();
    bring_to_ready();
    request(RequestKind::stand);
    ASSERT_EQ(run(0.1), State::stand);
    if (kind == RequestKind::none) {
      inputs_.shut_down = true;
    } else {
      request(kind);
    }
    EXPECT_EQ(tick(), State::ready);
    EXPECT_TRUE(only_damps());
    const State end = kind == RequestKind::sit ? State::ready : State::off;
    EXPECT_EQ(run(parameters_.damped_before_off_s + 0.1), end);
  }
}

TEST_F(SupervisorTest, AStopOfARobotThatCarriesItselfLetsItStandUpAndSitDown) {
  bring_to_ready();
  request(RequestKind::stand);
  ASSERT_EQ(run(0.5 * parameters_.stand_ramp_s + 0.01), State::stand);
  request(RequestKind::sit);
  for (double time_s = 0; time_s < parameters_.slow_down_s; time_s += 1e-3) {
    tick();
    ASSERT_TRUE(output().state == State::stand || output().state == State::sit) << time_s;
  }
  EXPECT_EQ(output().state, State::sit);
}

TEST_F(SupervisorTest, ARobotThatIsNotAtRestSitsOnceItIs) {
  bring_to_stand();
  run(10.0);
  inputs_.at_rest = false;
  request(RequestKind::sit);
  EXPECT_EQ(run(2.0), State::stand) << "it catches a push";
  inputs_.at_rest = true;
  EXPECT_EQ(tick(), State::sit);
}

TEST_F(SupervisorTest, ARobotThatDoesNotComeToRestSitsInTheEnd) {
  constexpr double kRestWait_s = 5.0;
  bring_to_stand();
  run(10.0);
  inputs_.at_rest = false;
  inputs_.shut_down = true;
  EXPECT_EQ(run(kRestWait_s - 0.002), State::stand);
  EXPECT_EQ(run(0.004), State::sit);
}

TEST_F(SupervisorTest, ARobotThatTipsOverWhileItSitsIsDamped) {
  bring_to_stand();
  request(RequestKind::sit);
  ASSERT_EQ(run(parameters_.slow_down_s + 0.1), State::sit);
  inputs_.seen.base.pitch_rad = parameters_.base_pitch_limit_rad + 0.1;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().latched.has(Fault::base_pitch_limit));
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, ShuttingDownSitsDampsAndDisables) {
  bring_to_walk();
  inputs_.shut_down = true;
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(run(parameters_.slow_down_s), State::stand);
  EXPECT_EQ(run(parameters_.slow_down_s - 0.001), State::stand) << "the swing foot has to come down first";
  EXPECT_EQ(tick(), State::sit);
  EXPECT_EQ(run(parameters_.sit_s), State::ready);
  for (double time_s = 0; time_s < parameters_.damped_before_off_s - 0.0015; time_s += 1e-3) {
    ASSERT_EQ(tick(), State::ready) << "its hip is still high: " << time_s;
    ASSERT_TRUE(only_damps());
  }
  EXPECT_EQ(tick(), State::off);
  EXPECT_EQ(action_, Action::disable);
  EXPECT_EQ(run(1), State::off);
}

TEST_F(SupervisorTest, SwitchingOffWhileWalkingSitsDownFirst) {
  bring_to_walk();
  request(RequestKind::off);
  EXPECT_EQ(run(2 * parameters_.slow_down_s + 0.1), State::sit);
  EXPECT_EQ(run(parameters_.sit_s), State::ready);
  EXPECT_EQ(run(parameters_.damped_before_off_s), State::off);
}

TEST_F(SupervisorTest, TorquesNeverExceedTheJoint) {
  bring_to_walk();
  wanted_[0].torque_Nm = 1e6;
  wanted_[1].torque_Nm = -1e6;
  tick();
  EXPECT_EQ(commands_[0].torque_Nm, 80);
  EXPECT_EQ(commands_[1].torque_Nm, -80);
}

/// Torque of the law of a driver that closes it itself, at a reading.
double law_Nm(const hal::JointCommand& command, const hal::JointReading& reading) {
  return command.torque_Nm + command.kp_Nm_rad * (command.position_rad - reading.position_rad) +
         command.kd_Nms_rad * (command.velocity_rad_s - reading.velocity_rad_s);
}

TEST_F(SupervisorTest, ATorqueLimitHoldsAtEveryLevel) {
  parameters_.torque_limit_share = 0.25;
  power_on();
  bring_to_stand();
  const auto expect_within_limit = [this](FallbackLevel level) {
    ASSERT_EQ(output().level, level);
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      const double limit_Nm = 0.25 * joint_limits().torque_Nm[i];
      const double rounding = 1 + 1e-12;
      EXPECT_LE(std::abs(commands_[i].torque_Nm), limit_Nm);
      EXPECT_LE(commands_[i].torque_limit_Nm, limit_Nm);
      EXPECT_LE(std::abs(law_Nm(commands_[i], inputs_.seen.joints[i])), limit_Nm * rounding);
    }
  };
  wanted_[0].torque_Nm = 500;
  tick();
  expect_within_limit(FallbackLevel::plan);
  EXPECT_EQ(commands_[0].torque_Nm, 0.25 * joint_limits().torque_Nm[0]) << "all that is left, where wanted";

  for (hal::JointReading& joint : inputs_.seen.joints) joint.velocity_rad_s = 9;
  inputs_.seen.joints[3].missed_replies = static_cast<std::uint32_t>(parameters_.missed_hold_ticks);
  run(2 * parameters_.hold_ramp_s);
  expect_within_limit(FallbackLevel::hold);
  inputs_.seen.joints[3].missed_replies = 0;
  inputs_.seen.joints[0].driver_temperature_C = parameters_.overheated_C + 1;
  for (double time_s = 0; time_s < 10 && output().level != FallbackLevel::sit; time_s += 1e-3) tick();
  for (hal::JointReading& joint : inputs_.seen.joints) joint.position_rad += 1.0;
  tick();
  expect_within_limit(FallbackLevel::sit);
  inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
  tick();
  expect_within_limit(FallbackLevel::damp);
}

TEST_F(SupervisorTest, WithLessTorqueThanAWalkNeedsItStandsAndNeitherStepsNorWalks) {
  parameters_.torque_limit_share = 0.5;
  power_on();
  bring_to_stand();
  for (const RequestKind kind : {RequestKind::step, RequestKind::walk}) {
    request(kind, 0.5);
    EXPECT_EQ(run(1.0), State::stand);
  }
  parameters_.torque_limit_share = 1.0;
  parameters_.plan_torque_share = 0.5;
  power_on();
  bring_to_stand();
  request(RequestKind::walk, 0.5);
  EXPECT_EQ(run(1.0), State::stand) << "plans have too little";
  parameters_.torque_limit_share = parameters_.plan_torque_share = parameters_.walk_torque_share;
  power_on();
  bring_to_walk();
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
    joint.missed_replies = 5000;
  }
  inputs_.seen.base.missed_replies = 5000;
  EXPECT_EQ(run(1), State::idle);
}

TEST_F(SupervisorTest, AFailedBringUpDisablesTheDrivers) {
  tick();
  request(RequestKind::calibrate);
  tick();
  inputs_.seen.bring_up_failed = true;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_EQ(output().level, FallbackLevel::off);
  EXPECT_EQ(action_, Action::disable);
  request(RequestKind::reset);
  EXPECT_EQ(run(0.01), State::idle);
}

TEST_F(SupervisorTest, ARobotThatLeavesTheStandingPoseWhileItStandsUpIsDampedAndMayTryAgain) {
  bring_to_ready();
  request(RequestKind::stand);
  run(0.5);
  ASSERT_EQ(output().state, State::stand);
  inputs_.in_stance = false;
  EXPECT_EQ(tick(), State::ready);
  EXPECT_TRUE(only_damps());
  EXPECT_TRUE(output().latched.empty());
  inputs_.in_stance = true;
  EXPECT_EQ(run(1), State::ready) << "not by itself";
  request(RequestKind::stand);
  EXPECT_EQ(run(parameters_.stand_ramp_s + 0.01), State::stand);
  inputs_.in_stance = false;
  EXPECT_EQ(run(0.1), State::stand) << "once it stands, steps may lead anywhere";
}

/// Whatever comes in, in whatever order: no torque without a state for it, no fault without its reaction.
TEST_F(SupervisorTest, RandomInputsNeverBreakTheRules) {
  constexpr unsigned kSeed = 20;
  std::mt19937 random(kSeed);
  parameters_.damped_before_off_s = 0.02;  // few requests to reset stand for longer
  power_on();
  std::uniform_int_distribution<int> thing(0, 400);
  std::uniform_int_distribution<int> kind(0, static_cast<int>(RequestKind::reset));
  State before = State::boot;
  for (int i = 0; i < 300'000; ++i) {
    const int chance = thing(random);
    if (chance == 0) request(static_cast<RequestKind>(kind(random)), 0.5);
    if (chance == 1) inputs_.seen.joints[0].missed_replies = 12;
    if (chance == 2) inputs_.seen.emergency_stop = hal::EmergencyStopState::pressed;
    if (chance == 3) inputs_.seen.base.pitch_rad = kNan;
    if (chance == 4) wanted_[2].torque_Nm = kNan;
    if (chance == 5) inputs_.seen.followable.plan = PlanUse::none;
    if (chance >= 6 && chance < 20) {
      const std::int64_t time_ns = inputs_.seen.time_ns;
      inputs_.seen = testing::healthy();
      inputs_.seen.time_ns = time_ns;
      wanted_[2].torque_Nm = 30;
    }
    inputs_.bring_up_done = chance < 100;
    const State state = tick();
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", tick " << i << ", " << name(state));
    ASSERT_TRUE(state != State::fault || only_damps() || action_ != Action::commands);
    ASSERT_TRUE(has_torque(state) || action_ != Action::commands || only_damps());
    ASSERT_TRUE(before != State::fault || state == State::fault || state == State::idle);
    ASSERT_TRUE(!has_torque(state) || has_torque(before) || before == State::ready);
    ASSERT_TRUE(!tracks(state) || output().reaction <= Reaction::sit);
    ASSERT_TRUE(state != State::walk || output().latched.empty()) << "on its way to sit";
    ASSERT_LE(std::abs(commands_[2].torque_Nm), 80);
    before = state;
  }
}

}  // namespace
}  // namespace stilt::supervisor
