#include "host_tools/recording/run/plan_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_tools/recording/run/tick_run.h"
#include "tests/host_tools/recording/record_sample.h"
#include "tests/robots.h"

namespace stilt::record {
namespace {

/// A message whose hip moves by 1 m/s from `x_m` over 0.4 s, in nodes of 0.1 s; its left foot lifts after 0.2
/// s.
class PlanMessage {
 public:
  PlanMessage(double start_s, float x_m) {
    for (int i = 0; i < 5; ++i) {
      const float time_s = 0.1f * static_cast<float>(i);
      time_.push_back(time_s);
      contact_.push_back(time_s < 0.15f ? 3 : 2);
      base_.insert(base_.end(), {x_m + time_s, 0.8f, 0.1f});
      joints_.insert(joints_.end(), {time_s, 0.0f, 0.0f, 0.0f});
      feet_.insert(feet_.end(), {0.1f, 0.0f, -0.1f, 0.0f});
      forces_.insert(forces_.end(), {0.0f, 10.0f * static_cast<float>(i), 0.0f, 100.0f});
    }
    message_.start_time_s = start_s;
    message_.count = 5;
    point(message_.time_s, time_);
    point(message_.contact, contact_);
    point(message_.base, base_);
    point(message_.joint_position_rad, joints_);
    point(message_.foot_position_m, feet_);
    point(message_.contact_force_N, forces_);
  }
  PlanMessage(const PlanMessage&) = delete;
  PlanMessage& operator=(const PlanMessage&) = delete;

  telemetry::Plan& message() { return message_; }

 private:
  template <class Sequence, class Values>
  static void point(Sequence& sequence, Values& values) {
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(values.size());
    sequence._buffer = values.data();
  }

  telemetry::Plan message_{};
  std::vector<float> time_, base_, joints_, feet_, forces_;
  std::vector<std::uint8_t> contact_;
};

TEST(PlanTrack, ThePlanInUseIsTheNewestThatHadBegun) {
  PlanTrack track;
  PlanMessage first(1.0, 0.0f), second(1.3, 5.0f);
  track.add(first.message());
  track.add(second.message());
  EXPECT_FALSE(track.at(0.99));
  const auto between = track.at(1.25);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->base_x_m, 0.25, 1e-6) << "linear";
  EXPECT_NEAR(between->joint_position_rad[0], 0.25, 1e-6);
  EXPECT_NEAR(between->contact_force_N[1], 20.0, 1e-6) << "held from 0.2 s on";
  EXPECT_FALSE(between->mode.left);
  EXPECT_TRUE(between->mode.right);
  EXPECT_NEAR(track.at(1.31)->base_x_m, 5.01, 1e-6);
  EXPECT_FALSE(track.at(1.71)) << "beyond its last node";
  EXPECT_EQ(track.snapshots().size(), 2u);
  EXPECT_NEAR(track.snapshots()[1].node_time_s.back(), 1.7, 1e-6);
}

TEST(PlanTrack, AMessageWhoseSequencesDoNotFitItsCountIsLeftOut) {
  PlanTrack track;
  PlanMessage plan(1.0, 0.0f);
  plan.message().count = 6;
  track.add(plan.message());
  plan.message().count = 5;
  plan.message().contact_force_N._length = 19;
  track.add(plan.message());
  EXPECT_TRUE(track.snapshots().empty());
  EXPECT_FALSE(track.at(1.1));
}

/// Touch-downs of a robot without foot sensors: the contacts of the plans in use. The left foot lifts 0.2 s
/// after the start of the first plan, which is in use for 0.35 s.
TEST(TickRun, AFootTouchesDownByAPlanAndNotByTheEndOfPlans) {
  const auto summary = [](bool plans_end, supervisor::State state, double force_N = NAN) {
    PlanTrack track;
    PlanMessage first(5.0, 0.0f), second(5.35, 0.35f);
    track.add(first.message());
    track.add(second.message());
    log::RunRecord run;
    run.controller.emplace();
    TickRun ticks(testing_support::amber3m().constants, 0, track, run);
    for (std::uint64_t number = 0; number < 500; ++number) {
      control_loop::TickRecord tick = sample_tick(number);
      tick.plan_sequence = number < 350 ? 1 : plans_end ? -1 : 2;
      tick.state = state;
      tick.base.left_foot_force_N = tick.base.right_foot_force_N = force_N;
      ticks.add(tick);
    }
    ticks.finish();
    return run.summary;
  };
  using enum supervisor::State;
  EXPECT_TRUE(summary(true, walk).steps.empty());
  EXPECT_FALSE(summary(true, walk).steps_known) << "it walked on without a plan";
  EXPECT_TRUE(summary(true, walk, 100.0).steps_known) << "by its foot sensors";
  EXPECT_TRUE(summary(true, stand).steps_known);
  const log::RunSummary whole = summary(false, walk);
  EXPECT_TRUE(whole.steps_known);
  ASSERT_EQ(whole.steps.size(), 1u);
  EXPECT_EQ(whole.steps[0].foot, "L");
  EXPECT_NEAR(whole.steps[0].time_s, 5.35, 1e-9);
}

/// No driver replies, and the robot does not get up.
TEST(TickRun, WhatWasNotMeasuredHasNoFigure) {
  const PlanTrack no_plans;
  log::RunRecord run;
  run.controller.emplace();
  TickRun ticks(testing_support::amber3m().constants, 0, no_plans, run);
  for (std::uint64_t number = 0; number < 10; ++number) {
    control_loop::TickRecord tick = sample_tick(number);
    tick.stance_episode = 0;
    tick.joints[1].torque_Nm = -0.5;
    ticks.add(tick);
  }
  ticks.finish();
  const log::RunSummary& summary = run.summary;
  EXPECT_TRUE(std::isnan(summary.peak_torque_Nm[0]));
  EXPECT_TRUE(std::isnan(summary.peak_joint_speed_rad_s[0]));
  EXPECT_EQ(summary.peak_torque_Nm[1], 0.5);
  EXPECT_TRUE(std::isnan(summary.distance_m));
  EXPECT_TRUE(std::isnan(summary.mean_speed_m_s));
  EXPECT_TRUE(summary.steps_known) << "it did not walk";
}

/// Its estimate has the hip at the origin then.
TEST(TickRun, OffItsFeetARobotHasNoPlaceOfItsHipAndMakesNoSteps) {
  const PlanTrack no_plans;
  log::RunRecord run;
  run.controller.emplace();
  TickRun ticks(testing_support::amber3m().constants, 0, no_plans, run);
  for (std::uint64_t number = 0; number < 400; ++number) {
    control_loop::TickRecord tick = sample_tick(number);
    tick.stance_episode = number < 200 ? 0 : 1;
    if (number < 200) tick.estimated_state[1] = 0.0;
    tick.estimated_state[3] = 0.5;
    tick.base.left_foot_force_N = number < 100 ? 0.0 : 100.0;  // the gantry lets it down
    tick.base.right_foot_force_N = 100.0;
    ticks.add(tick);
  }
  ticks.finish();
  const log::RunSample &off = run.samples.at(20), &on = run.samples.at(60);
  for (const Eigen::Index i : {0, 1, 7, 8}) {
    EXPECT_TRUE(std::isnan(off.estimated_state[i])) << i;
    EXPECT_FALSE(std::isnan(on.estimated_state[i])) << i;
  }
  EXPECT_EQ(off.estimated_state[3], 0.5) << "the joints are measured";
  EXPECT_EQ(off.estimated_state[2], 0.0);
  EXPECT_TRUE(std::isnan(off.foot_position_m[1]));
  EXPECT_EQ(on.estimated_state[1], 0.75);
  EXPECT_FALSE(std::isnan(on.foot_position_m[1]));
  EXPECT_TRUE(run.summary.steps.empty());
}

/// Two walks of 0.3 m each at 1 m/s. In each of them the estimate starts at 0 again. Between them the robot
/// sits, or the ticks are missing.
TEST(TickRun, TheDistanceIsTheSumOfAllStands) {
  for (const bool missing : {false, true}) {
    const PlanTrack no_plans;
    log::RunRecord run;
    run.controller.emplace();
    TickRun ticks(testing_support::amber3m().constants, 0, no_plans, run);
    for (std::uint64_t number = 0; number < 900; ++number) {
      const bool sits = number > 300 && number < 599;
      if (sits && missing) continue;
      control_loop::TickRecord tick = sample_tick(number);
      tick.stance_episode = sits ? 0 : number < 500 ? 1 : 2;
      tick.state = sits ? supervisor::State::sit : supervisor::State::walk;
      tick.estimated_state[0] =
          sits ? 0.0 : 0.001 * static_cast<double>(number < 500 ? number : number - 599);
      ticks.add(tick);
    }
    ticks.finish();
    EXPECT_NEAR(run.summary.distance_m, 0.6, 1e-9) << missing;
    EXPECT_NEAR(run.summary.mean_speed_m_s, 1.0, 1e-9) << missing;
  }
}

/// Missing ticks, and whether the steps of a robot with foot sensors are known all the same.
TEST(TickRun, MissingTicksAreNamedAndHideStepsWhenTheyAreLong) {
  for (const std::uint64_t end : {201u, 240u, 300u}) {
    const PlanTrack no_plans;
    log::RunRecord run;
    run.controller.emplace();
    TickRun ticks(testing_support::amber3m().constants, 5'000'000'000, no_plans, run);
    for (std::uint64_t number = 100; number < 400; ++number) {
      if (number >= 200 && number < end) continue;
      control_loop::TickRecord tick = sample_tick(number);
      tick.base.left_foot_force_N = number > 150 && number < 250 ? 0.0 : 100.0;
      tick.base.right_foot_force_N = 100.0;
      ticks.add(tick);
    }
    ticks.finish();
    ASSERT_EQ(run.missing_ticks.size(), 1u);
    const log::MissingTicks& missing = run.missing_ticks[0];
    EXPECT_EQ(missing.first, 200u);
    EXPECT_EQ(missing.last, end - 1);
    EXPECT_NEAR(missing.from_s, 0.2, 1e-9);
    EXPECT_NEAR(missing.to_s, 0.001 * static_cast<double>(end - 1), 1e-9);
    EXPECT_EQ(run.summary.steps_known, end < 300) << end;
    EXPECT_EQ(run.summary.steps.size(), end < 300 ? 1u : 0u) << end;
  }
}

}  // namespace
}  // namespace stilt::record
