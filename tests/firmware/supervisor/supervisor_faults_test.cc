// What faults do to a robot that walks.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/firmware/supervisor/spoils.h"
#include "tests/firmware/supervisor/supervisor_rig.h"

namespace stilt::supervisor {
namespace {

using testing::kSpoils;
using testing::Spoil;
using testing::SupervisorTest;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST_F(SupervisorTest, AFaultThatAsksToSitStepsToAStandFirst) {
  bring_to_walk();
  inputs_.seen.joints[0].motor_temperature_C = 120;
  EXPECT_EQ(tick(), State::step) << "at once";
  EXPECT_EQ(output().level, FallbackLevel::plan) << "the plan is followed all along";
  EXPECT_EQ(output().gait.speed_m_s, 0);
  EXPECT_EQ(run(parameters_.slow_down_s - 0.002), State::step);
  EXPECT_EQ(run(0.003), State::stand);
  EXPECT_EQ(output().level, FallbackLevel::plan);
  EXPECT_EQ(run(parameters_.slow_down_s - 0.002), State::stand) << "the swing foot has to come down";
  EXPECT_EQ(run(0.003), State::sit);
  EXPECT_EQ(output().level, FallbackLevel::sit);
  EXPECT_EQ(run(parameters_.sit_s + 0.001), State::fault) << "5 s after the fault, as the table says";
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, OnItsWayToSitItDoesNotWalkAgain) {
  bring_to_walk();
  inputs_.seen.joints[0].supply_V = 30;
  tick();
  inputs_.seen.joints[0].supply_V = 48;
  for (const RequestKind kind : {RequestKind::stand, RequestKind::step, RequestKind::walk}) {
    request(kind, 0.5);
    for (int i = 0; i < 100; ++i) {
      tick();
      ASSERT_EQ(output().state, State::step) << i;
    }
  }
  run(2 * parameters_.slow_down_s);
  EXPECT_EQ(output().state, State::sit);
}

TEST_F(SupervisorTest, MissedRepliesHoldThePoseOnTheWayToSitToo) {
  bring_to_walk();
  inputs_.seen.joints[0].motor_temperature_C = 120;
  run(0.1);
  inputs_.seen.joints[1].missed_replies = 5;
  tick();
  EXPECT_EQ(output().level, FallbackLevel::hold);
  inputs_.seen.joints[1].missed_replies = 0;
  tick();
  EXPECT_EQ(output().level, FallbackLevel::plan);
}

TEST_F(SupervisorTest, AFaultThatAsksToSitSitsAtOnceWithNothingToStepWith) {
  bring_to_walk();
  inputs_.seen.joints[0].motor_temperature_C = 120;
  EXPECT_EQ(tick(), State::step);
  inputs_.seen.followable.plan = PlanUse::none;
  inputs_.seen.followable.gait = true;
  EXPECT_EQ(tick(), State::step) << "a gait will do";
  EXPECT_EQ(output().level, FallbackLevel::gait);
  inputs_.seen.followable.gait = false;
  EXPECT_EQ(tick(), State::sit);
}

TEST_F(SupervisorTest, WithoutPlansItGoesOnWithAGaitAndBack) {
  bring_to_walk();
  run(0.3);
  inputs_.seen.followable.gait = true;
  inputs_.seen.followable.plan = PlanUse::none;
  EXPECT_EQ(tick(), State::walk);
  EXPECT_EQ(output().level, FallbackLevel::gait);
  EXPECT_TRUE(output().present.has(Fault::plan_missing));
  EXPECT_EQ(commands_[0].torque_Nm, 30) << "torque of the gait";
  EXPECT_EQ(run(3), State::walk);
  inputs_.seen.followable.plan = PlanUse::as_it_is;
  tick();
  EXPECT_EQ(output().level, FallbackLevel::plan);
  EXPECT_TRUE(output().latched.empty());
}

TEST_F(SupervisorTest, ALostHeartbeatStopsWalkingAndItsReturnDoesNotStartItAgain) {
  inputs_.seen.heartbeat_expected = true;
  bring_to_walk();
  inputs_.seen.heartbeat_age_s = 0.5;
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(output().level, FallbackLevel::plan) << "and the plan is followed all along";
  EXPECT_EQ(run(parameters_.slow_down_s - 0.002), State::step) << "in place, until it has slowed down";
  EXPECT_EQ(run(0.012), State::stand);
  EXPECT_TRUE(output().latched.empty());
  inputs_.seen.heartbeat_age_s = 0;
  EXPECT_EQ(run(1), State::stand);
  request(RequestKind::walk, 0.3);
  EXPECT_EQ(tick(), State::walk);
}

TEST_F(SupervisorTest, AHeartbeatThatIsSoonBackLeavesTheRobotStandingUnlessItIsAskedToGoOn) {
  for (const bool asks_again : {false, true}) {
    power_on();
    inputs_.seen.heartbeat_expected = true;
    bring_to_walk();
    inputs_.seen.heartbeat_age_s = 0.5;
    EXPECT_EQ(run(0.5), State::step);
    inputs_.seen.heartbeat_age_s = 0;
    EXPECT_EQ(run(0.1), State::step);
    if (asks_again) request(RequestKind::step);
    EXPECT_EQ(run(parameters_.slow_down_s), asks_again ? State::step : State::stand);
    EXPECT_EQ(run(10.0), asks_again ? State::step : State::stand);
  }
}

TEST_F(SupervisorTest, ARobotThatWasAskedToSitOrSwitchOffRestsAlsoWithoutItsHost) {
  for (const auto& [kind, rest] :
       {std::pair(RequestKind::sit, State::ready), {RequestKind::off, State::off}}) {
    power_on();
    inputs_.seen.heartbeat_expected = true;
    bring_to_walk();
    request(kind);
    EXPECT_EQ(run(0.1), State::step);
    inputs_.seen.heartbeat_age_s = 0.5;
    EXPECT_EQ(run(2 * parameters_.slow_down_s + 0.1), State::sit);
    EXPECT_EQ(run(parameters_.sit_s + parameters_.damped_before_off_s + 0.1), rest);
  }
}

TEST_F(SupervisorTest, WithoutAnOperatorItSitsInTheEnd) {
  inputs_.seen.heartbeat_expected = true;
  bring_to_walk();
  inputs_.seen.heartbeat_age_s = 0.5;
  EXPECT_EQ(run(parameters_.slow_down_s + 0.1), State::stand);
  inputs_.seen.heartbeat_age_s = parameters_.operator_gone_s + 0.1;
  EXPECT_EQ(run(parameters_.slow_down_s), State::sit);
  EXPECT_EQ(run(parameters_.sit_s + 0.1), State::fault);
  EXPECT_TRUE(output().latched.has(Fault::operator_gone));
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, APlannerThatIsLostEndsAWalkOnAGait) {
  bring_to_walk();
  inputs_.seen.followable = {.plan = PlanUse::none, .gait = true};
  inputs_.seen.plan_age_s = parameters_.planner_lost_s - 0.1;
  EXPECT_EQ(run(1), State::walk);
  inputs_.seen.plan_age_s = parameters_.planner_lost_s + 0.1;
  EXPECT_EQ(tick(), State::step);
  EXPECT_EQ(output().level, FallbackLevel::gait) << "it steps on the gait until it has slowed down";
  EXPECT_EQ(run(parameters_.slow_down_s), State::stand);
  inputs_.seen.followable.gait = false;
  EXPECT_EQ(tick(), State::sit) << "no gait stands, so nothing balances it";
}

TEST_F(SupervisorTest, MissedRepliesOfOneJointDoNotUnloadTheOthers) {
  bring_to_walk();
  wanted_[1].torque_Nm = 45;
  tick();
  for (std::uint32_t missed = 1; missed < 10; ++missed) {
    inputs_.seen.joints[2].missed_replies = missed;
    wanted_.fill({});  // the torque law is not in command at this level
    if (missed < 3) wanted_[1].torque_Nm = 45;
    tick();
    EXPECT_GE(commands_[1].torque_Nm, 45 * (1 - 6e-3 / parameters_.hold_ramp_s) - 1e-9) << missed;
  }
  inputs_.seen.joints[2].missed_replies = 0;
  wanted_[1].torque_Nm = 45;
  tick();
  EXPECT_EQ(commands_[1].torque_Nm, 45);
}

TEST_F(SupervisorTest, SittingTakesOverTheTorqueWithoutAStep) {
  bring_to_walk();
  tick();
  inputs_.seen.followable.plan = PlanUse::none;
  double before_Nm = commands_[1].torque_Nm;
  for (double time_s = 0; time_s < 2 * parameters_.hold_ramp_s; time_s += 1e-3) {
    tick();
    EXPECT_NEAR(commands_[1].torque_Nm, before_Nm, 30 * 1.001e-3 / parameters_.hold_ramp_s);
    before_Nm = commands_[1].torque_Nm;
  }
  EXPECT_EQ(before_Nm, 0);
  EXPECT_EQ(commands_[1].kp_Nm_rad, parameters_.hold_kp_Nm_rad);
}

TEST_F(SupervisorTest, ThreeMissedRepliesHoldThePoseAndTenDamp) {
  bring_to_walk();
  const double pose_rad = inputs_.seen.joints[0].position_rad;
  for (std::uint32_t missed = 1; missed <= 9; ++missed) {
    inputs_.seen.joints[1].missed_replies = missed;
    EXPECT_EQ(tick(), State::walk);
    EXPECT_EQ(output().level, missed < 3 ? FallbackLevel::plan : FallbackLevel::hold) << missed;
    const double held_s = 1e-3 * (static_cast<double>(missed) - 3);
    const double share = std::clamp(held_s / parameters_.hold_ramp_s, 0.0, 1.0);
    if (missed >= 3) {
      EXPECT_NEAR(commands_[0].kp_Nm_rad, share * parameters_.hold_kp_Nm_rad, 1e-9) << missed;
      EXPECT_NEAR(commands_[0].kd_Nms_rad, share * parameters_.hold_kd_Nms_rad, 1e-9) << missed;
    }
  }
  EXPECT_EQ(commands_[0].position_rad, pose_rad);
  EXPECT_GT(commands_[0].kp_Nm_rad, 0);
  EXPECT_NEAR(commands_[0].torque_Nm, 30 * (1 - 6e-3 / parameters_.hold_ramp_s), 1e-9)
      << "what carried the robot fades while the gains grow";
  inputs_.seen.joints[1].missed_replies = 10;
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, RepliesThatComeBackInTimeLetItWalkOn) {
  bring_to_walk();
  inputs_.seen.joints[1].missed_replies = 5;
  tick();
  EXPECT_EQ(output().level, FallbackLevel::hold);
  inputs_.seen.joints[1].missed_replies = 0;
  EXPECT_EQ(tick(), State::walk);
  EXPECT_EQ(output().level, FallbackLevel::plan);
  EXPECT_EQ(commands_[0].torque_Nm, 30);
}

TEST_F(SupervisorTest, AStalePlanSitsDownAndThenDamps) {
  bring_to_walk();
  inputs_.seen.followable.plan = PlanUse::with_feedback;
  EXPECT_EQ(tick(), State::walk);
  EXPECT_EQ(output().level, FallbackLevel::plan_feedback);
  inputs_.seen.followable.plan = PlanUse::none;
  EXPECT_EQ(tick(), State::sit);
  EXPECT_EQ(output().level, FallbackLevel::sit);
  EXPECT_NEAR(commands_[1].position_rad, inputs_.seen.joints[1].position_rad, 1e-9)
      << "from the measured pose";
  run(parameters_.sit_s - 0.005);
  EXPECT_EQ(output().state, State::sit);
  EXPECT_NEAR(commands_[0].position_rad, parameters_.sit_hip_rad, 1e-3);
  EXPECT_NEAR(commands_[1].position_rad, parameters_.sit_knee_rad, 1e-3);
  EXPECT_EQ(run(0.01), State::fault) << "latched";
  EXPECT_TRUE(only_damps());
}

TEST_F(SupervisorTest, CommandsThatAreNotFiniteNeverLeave) {
  bring_to_walk();
  wanted_[3].torque_Nm = kNan;
  tick();
  EXPECT_TRUE(only_damps()) << "in the very tick";
  EXPECT_EQ(tick(), State::fault);
  EXPECT_TRUE(output().latched.has(Fault::not_finite));
}

TEST_F(SupervisorTest, EveryLatchingFaultEndsInFaultWithoutAWayBack) {
  parameters_.damped_before_off_s = 100;  // then the motors are off, see AfterAnEmergencyStopItSettles
  for (const Spoil& spoil : kSpoils) {
    if (row(spoil.fault).severity != Severity::latched || row(spoil.fault).watch == Watch::bring_up) continue;
    SCOPED_TRACE(name(spoil.fault));
    power_on();
    bring_to_walk();
    run(0.3);
    spoil.apply(inputs_.seen);
    const State first = tick();
    const bool sits = row(spoil.fault).reaction == Reaction::sit;
    const bool steps = sits && spoil.fault != Fault::stale_plan;
    EXPECT_EQ(first, steps ? State::step : sits ? State::sit : State::fault);
    EXPECT_EQ(output().reaction, row(spoil.fault).reaction);
    EXPECT_TRUE(output().latched.has(spoil.fault));
    EXPECT_EQ(run(2 * parameters_.slow_down_s + parameters_.sit_s + 0.1), State::fault);
    const std::int64_t time_ns = inputs_.seen.time_ns;
    inputs_.seen = testing::healthy();
    inputs_.seen.time_ns = time_ns;
    EXPECT_EQ(run(1), State::fault) << "the cause alone going away is not enough";
    EXPECT_TRUE(only_damps());
  }
}

}  // namespace
}  // namespace stilt::supervisor
