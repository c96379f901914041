#include "mpc_core/gait/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "tests/mpc_core/printers.h"

namespace stilt::gait {
namespace {

constexpr double kCycle_s = 0.01;  // of the planner
constexpr double kAhead_s = 3.0;   // how far the planner asks to see
constexpr GaitCommand kStand{GaitKind::stand, 0.0};
constexpr GaitCommand kStep{GaitKind::step, 0.0};
constexpr GaitCommand kWalk{GaitKind::walk, 0.5};

/// A schedule driven like the planner drives it, and the phases that really came to pass.
struct Driver {
  GaitParameters gait{.single_support_s = 0.4};
  ReferenceParameters reference;
  ContactSchedule schedule;
  double time_s = 0.0;
  double speed_m_s = 0.0;
  std::vector<ContactPhase> lived;

  explicit Driver(double double_support_s = 0.0, double start_s = 0.0) : time_s(start_s) {
    gait.double_support_s = double_support_s;
    schedule.reset(start_s);
    note();
  }

  void cycle(const GaitCommand& command, bool left_ahead = true) {
    schedule.update(time_s, time_s + kAhead_s, command, gait, reference, speed_m_s, left_ahead);
    note();
    time_s += kCycle_s;
  }
  void run(const GaitCommand& command, double duration_s, bool left_ahead = true) {
    const long cycles = std::lround(duration_s / kCycle_s);
    for (long i = 0; i < cycles; ++i) cycle(command, left_ahead);
  }
  [[nodiscard]] const ContactPhase& now() const { return schedule.phase(schedule.index_at(time_s)); }

 private:
  void note() {
    const ContactPhase& present = schedule.phase(schedule.index_at(time_s));
    if (lived.empty() || lived.back().start_s != present.start_s) lived.push_back(present);
  }
};

bool is_double(const ContactPhase& phase) { return phase.mode.count() == 2; }

TEST(Schedule, StandsOnBothFeetWithoutEndAfterAReset) {
  ContactSchedule schedule;
  schedule.reset(2.0);
  ASSERT_EQ(schedule.count(), 1);
  EXPECT_EQ(schedule.phase(0).mode, (model::ContactMode{true, true}));
  EXPECT_EQ(schedule.phase(0).gait, GaitKind::stand);
  EXPECT_EQ(schedule.end_s(0), ContactSchedule::kNever_s);
}

TEST(Schedule, GoesFromStandingOverSteppingAndWalkingBackToStanding) {
  for (const double double_support_s : {0.0, 0.06}) {
    Driver driver(double_support_s);
    std::vector<GaitKind> order;
    const auto note = [&] {
      if (order.empty() || order.back() != driver.now().gait) order.push_back(driver.now().gait);
    };
    const auto run = [&](const GaitCommand& command, double duration_s) {
      for (int i = 0; i < std::lround(duration_s / kCycle_s); ++i) {
        driver.cycle(command);
        note();
      }
    };
    run(kStand, 1.0);
    run(kStep, 2.0);
    run(kWalk, 2.0);
    driver.speed_m_s = 0.5;
    run(kStand, 3.0);
    EXPECT_EQ(order, (std::vector<GaitKind>{GaitKind::stand, GaitKind::step, GaitKind::walk, GaitKind::step,
                                            GaitKind::stand}))
        << "double support " << double_support_s;
    EXPECT_TRUE(is_double(driver.now()));
  }
}

TEST(Schedule, StepsOnAlternateFeetForTheTimesConfigured) {
  for (const double double_support_s : {0.0, 0.06}) {
    Driver driver(double_support_s);
    driver.run(kWalk, 10.0);
    model::ContactMode last_single{};
    int steps = 0;
    for (std::size_t i = 1; i + 1 < driver.lived.size(); ++i) {
      const ContactPhase& phase = driver.lived[i];
      const double duration_s = driver.lived[i + 1].start_s - phase.start_s;
      EXPECT_NEAR(duration_s, is_double(phase) ? double_support_s : 0.4, 1e-12) << "phase " << i;
      if (is_double(phase)) {
        EXPECT_GT(double_support_s, 0.0);
        EXPECT_FALSE(is_double(driver.lived[i + 1])) << "phase " << i;
        continue;
      }
      ASSERT_EQ(phase.mode.count(), 1);
      if (steps++ > 0) {
        EXPECT_NE(phase.mode, last_single) << "phase " << i;
      }
      if (double_support_s > 0.0) {
        EXPECT_TRUE(is_double(driver.lived[i + 1]));
      }
      last_single = phase.mode;
    }
    EXPECT_GT(steps, 19);
  }
}

TEST(Schedule, LiftsOffTheLeadTimeAfterTheCommandAtTheEarliest) {
  Driver driver;
  driver.run(kStand, 1.0);
  driver.cycle(kWalk);
  ASSERT_GE(driver.schedule.count(), 2);
  EXPECT_NEAR(driver.schedule.phase(1).start_s, 1.0 + driver.gait.switch_lead_s, 1e-9);
  driver.run(kWalk, 2.0);
  EXPECT_NEAR(driver.lived[1].start_s, 1.0 + driver.gait.switch_lead_s, 1e-9) << "and stays there";
}

TEST(Schedule, LiftsTheLeadingFootFirstToWalkForwardAndTheOtherBackward) {
  for (const bool left_ahead : {true, false}) {
    for (const double speed_m_s : {0.5, -0.3}) {
      Driver driver;
      driver.run({GaitKind::walk, speed_m_s}, 0.5, left_ahead);
      const bool lifts_left = !driver.lived[1].mode.left;
      EXPECT_EQ(lifts_left, left_ahead == (speed_m_s > 0.0))
          << "left ahead " << left_ahead << " " << speed_m_s;
    }
  }
}

TEST(Schedule, ACommandNeverChangesThePresentPhaseNorThePast) {
  constexpr std::uint64_t kSeed = 3;
  std::mt19937_64 random(kSeed);
  for (const double double_support_s : {0.0, 0.06}) {
    Driver driver(double_support_s);
    GaitCommand command = kStand;
    double planned_end_s = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const bool change = random() % 37 == 0;
      if (change) command = std::array{kStand, kStep, kWalk}[random() % 3];
      driver.speed_m_s = command.speed_m_s;
      const ContactPhase before = driver.now();
      planned_end_s = driver.schedule.end_s(driver.schedule.index_at(driver.time_s));
      driver.cycle(command);
      const double at_s = driver.time_s - kCycle_s;
      const int index = driver.schedule.index_at(at_s);
      ASSERT_EQ(driver.schedule.phase(index).start_s, before.start_s) << "seed " << kSeed << " cycle " << i;
      ASSERT_EQ(driver.schedule.phase(index).mode, before.mode) << "seed " << kSeed << " cycle " << i;
      if (before.gait != GaitKind::stand) {
        // The step under way ends when it was going to, whatever comes next.
        ASSERT_EQ(driver.schedule.end_s(index), planned_end_s) << "seed " << kSeed << " cycle " << i;
      }
    }
  }
}

TEST(Schedule, StepsStayAlternateUnderRandomCommands) {
  constexpr std::uint64_t kSeed = 4;
  std::mt19937_64 random(kSeed);
  for (const double double_support_s : {0.0, 0.06}) {
    Driver driver(double_support_s);
    GaitCommand command = kStand;
    for (int i = 0; i < 50000; ++i) {
      if (random() % 53 == 0) command = std::array{kStand, kStep, kWalk}[random() % 3];
      driver.speed_m_s = command.speed_m_s;
      driver.cycle(command, random() % 2 == 0);
    }
    ASSERT_GT(driver.lived.size(), 100U);
    model::ContactMode last{};
    for (std::size_t i = 1; i < driver.lived.size(); ++i) {
      const ContactPhase& phase = driver.lived[i];
      if (phase.gait == GaitKind::stand) last = {};  // either foot may start
      if (is_double(phase)) continue;
      EXPECT_NE(phase.mode, last) << "seed " << kSeed << " phase " << i << " at " << phase.start_s;
      last = phase.mode;
    }
  }
}

TEST(Schedule, ChangesBetweenStepAndWalkAtTheNextStep) {
  Driver driver;
  driver.run(kStep, 1.0);  // lift-off at 0.3, next steps at 0.7, 1.1, ...
  driver.run(kWalk, 0.5);
  double change_s = 0.0;
  for (const ContactPhase& phase : driver.lived) {
    if (phase.gait == GaitKind::walk && change_s == 0.0) change_s = phase.start_s;
  }
  EXPECT_NEAR(change_s, 1.1, 1e-9);
}

TEST(Schedule, AStopTakesTheStepsThatTheDecelerationNeeds) {
  for (const double double_support_s : {0.0, 0.06}) {
    for (const double speed_m_s : {0.0, 0.2, -0.3, 0.5, 0.8, 1.2}) {
      Driver driver(double_support_s);
      driver.run({GaitKind::walk, speed_m_s}, 4.0);
      driver.speed_m_s = speed_m_s;
      const double command_s = driver.time_s;
      driver.run(kStand, 4.0);
      ASSERT_EQ(driver.now().gait, GaitKind::stand);
      const double stand_s = driver.lived.back().start_s;
      // The speed ramps down from the next step on at the latest; the step under way when it has is the last
      // but one.
      const double ramp_s = std::abs(speed_m_s) / driver.reference.speed_ramp_m_s2;
      const double step_s = 0.4 + double_support_s;
      EXPECT_GE(stand_s, command_s + ramp_s) << speed_m_s;
      EXPECT_GE(driver.lived[driver.lived.size() - 2].start_s, command_s + ramp_s)
          << speed_m_s << ": the last step settles";
      EXPECT_LE(stand_s, command_s + ramp_s + 3.0 * step_s) << speed_m_s;
    }
  }
}

/// Swings that begin after a stop, so long after a lift-off: single support of 0.4 s, double of 0.1 s.
long swings_after_a_stop(double since_lift_off_s) {
  Driver driver(0.1);
  driver.run(kStep, 2.0);
  while (!is_double(driver.now())) driver.cycle(kStep);
  while (is_double(driver.now())) driver.cycle(kStep);
  driver.run(kStep, since_lift_off_s);
  const auto lived = static_cast<std::ptrdiff_t>(driver.lived.size());
  driver.run(kStand, 5.0);
  return std::count_if(driver.lived.begin() + lived, driver.lived.end(),
                       [](const ContactPhase& phase) { return !is_double(phase); });
}

/// The last foot but one makes room between the feet: one that has landed, or soon does, no longer can.
TEST(Schedule, AStopThatTheSwingIsTooOldForTakesOneStepMore) {
  EXPECT_EQ(swings_after_a_stop(0.3), swings_after_a_stop(0.1) + 1);
  EXPECT_EQ(swings_after_a_stop(0.45), swings_after_a_stop(0.3)) << "in double support";
}

TEST(Schedule, StandsStillForeverOnceStopped) {
  Driver driver;
  driver.run(kWalk, 2.0);
  driver.run(kStand, 5.0);
  const double stand_s = driver.lived.back().start_s;
  driver.run(kStand, 60.0);
  EXPECT_EQ(driver.lived.back().start_s, stand_s);
  EXPECT_EQ(driver.schedule.end_s(driver.schedule.count() - 1), ContactSchedule::kNever_s);
}

TEST(Schedule, AnHourOfWalkingNeedsNoMoreMemoryThanAMinute) {
  Driver driver(0.06);
  int most = 0;
  for (int i = 0; i < 360000; ++i) {
    driver.cycle(kWalk);
    most = std::max(most, driver.schedule.count());
    // Always planned far enough ahead, and always with enough past for the swing foot's last contact.
    ASSERT_GT(driver.schedule.phase(driver.schedule.count() - 1).start_s,
              driver.time_s + kAhead_s - kCycle_s);
    const int present = driver.schedule.index_at(driver.time_s);
    for (int foot = 0; foot < model::kFeet && driver.time_s > 3.0; ++foot) {
      const double lift_off_s = driver.schedule.foot_interval(present, foot).start_s;
      ASSERT_GT(driver.schedule.index_at(lift_off_s), 0);
    }
  }
  EXPECT_LE(most, 24);
  EXPECT_NEAR(static_cast<double>(driver.lived.size()), 3600.0 / 0.46 * 2.0, 3.0);
}

TEST(Schedule, FootIntervalSpansAllPhasesInWhichTheFootKeepsItsState) {
  Driver driver(0.06);
  driver.run(kWalk, 3.0);
  const int count = driver.schedule.count();
  for (int index = 1; index + 4 < count; ++index) {
    for (int foot = 0; foot < model::kFeet; ++foot) {
      const Interval interval = driver.schedule.foot_interval(index, foot);
      const bool contact = driver.schedule.phase(index).mode[foot];
      EXPECT_LE(interval.start_s, driver.schedule.phase(index).start_s);
      EXPECT_GE(interval.end_s, driver.schedule.end_s(index));
      for (double t = interval.start_s + 1e-6; t < interval.end_s; t += 0.01) {
        EXPECT_EQ(driver.schedule.phase(driver.schedule.index_at(t)).mode[foot], contact);
      }
      EXPECT_NE(driver.schedule.phase(driver.schedule.index_at(interval.end_s)).mode[foot], contact);
      if (index > 3 && index + 5 < count) {
        EXPECT_NEAR(interval.end_s - interval.start_s, contact ? 0.52 : 0.4, 1e-9);
      }
    }
  }
}

TEST(Schedule, ABoundaryBelongsToTheLaterPhase) {
  Driver driver;
  driver.run(kWalk, 0.5);
  for (int index = 0; index < driver.schedule.count(); ++index) {
    EXPECT_EQ(driver.schedule.index_at(driver.schedule.phase(index).start_s), index);
  }
}

TEST(Schedule, AFallingRobotLiftsTheFootFartherFromTheFallAfterTheShortLead) {
  for (const bool left_ahead : {true, false}) {
    for (const Fall fall : {Fall::forward, Fall::backward}) {
      ContactSchedule schedule;
      schedule.reset(0.0);
      const GaitParameters gait;
      constexpr double kNow_s = 5.0;
      schedule.update(kNow_s, kNow_s + kAhead_s, {GaitKind::step, 0.0}, gait, {}, 0.0, left_ahead, fall);
      const ContactPhase& first = schedule.phase(schedule.index_at(kNow_s) + 1);
      EXPECT_EQ(first.start_s, kNow_s + gait.catch_lead_s);
      const bool left_lifts = !first.mode.left;
      EXPECT_EQ(left_lifts, left_ahead == (fall == Fall::backward));
      EXPECT_EQ(first.mode.count(), 1);
    }
  }
}

/// A gait steps every 0.31 s, the schedule every 0.4 s. The planner's present phase is the gait's, and ends
/// when the gait's step does.
TEST(Schedule, KeepsInStepWithAGaitThatIsTracked) {
  constexpr double kStep_s = 0.31;
  Driver driver;
  driver.run(kWalk, 3.0);
  TrackedStep tracked{model::kRight, driver.time_s, kStep_s};
  for (int step = 0; step < 12; ++step) {
    while (driver.time_s < tracked.touch_down_s + kStep_s - 1e-9) {
      driver.schedule.update(driver.time_s, driver.time_s + kAhead_s, kWalk, driver.gait, driver.reference,
                             0.5, true, Fall::none, tracked);
      const int index = driver.schedule.index_at(driver.time_s);
      const ContactPhase& now = driver.schedule.phase(index);
      ASSERT_EQ(now.start_s, tracked.touch_down_s);
      ASSERT_EQ(now.mode, (model::ContactMode{tracked.stance_foot == model::kLeft,
                                              tracked.stance_foot == model::kRight}));
      EXPECT_EQ(now.gait, GaitKind::walk);
      const double end_s = std::max(tracked.touch_down_s + kStep_s, driver.time_s + 0.01);
      ASSERT_NEAR(driver.schedule.end_s(index), end_s, 1e-12);
      for (int i = index + 1; i < driver.schedule.count(); ++i) {
        ASSERT_NE(driver.schedule.phase(i).mode, driver.schedule.phase(i - 1).mode) << "alternate feet";
      }
      ASSERT_GT(driver.schedule.phase(driver.schedule.count() - 1).start_s, driver.time_s + kAhead_s);
      driver.time_s += kCycle_s;
    }
    tracked = {1 - tracked.stance_foot, driver.time_s, kStep_s};
  }
}

TEST(Schedule, AStopOutOfATrackedGaitTakesTheStepsOfAStop) {
  Driver driver;
  driver.run(kWalk, 3.0);
  const TrackedStep tracked{model::kLeft, driver.time_s - 0.1, 0.31};
  const auto update = [&](const GaitCommand& command, const TrackedStep& step) {
    driver.schedule.update(driver.time_s, driver.time_s + kAhead_s, command, driver.gait, driver.reference,
                           0.5, true, Fall::none, step);
  };
  for (int cycle = 0; cycle < 5; ++cycle) {
    update(kStand, tracked);
    driver.time_s += kCycle_s;
  }
  update(kStand, {});  // the plan is followed again
  const int last = driver.schedule.count() - 1;
  EXPECT_EQ(driver.schedule.phase(last).gait, GaitKind::stand);
  // 0.5 m/s at 1 m/s^2 in steps of 0.4 s: two, and one to settle.
  EXPECT_EQ(last - driver.schedule.index_at(driver.time_s), 4);
}

TEST(Schedule, ATrackedStepThatLastsLongerEndsSoon) {
  Driver driver;
  driver.run(kWalk, 3.0);
  const TrackedStep tracked{model::kLeft, driver.time_s - 0.4, 0.31};
  driver.schedule.update(driver.time_s, driver.time_s + kAhead_s, kWalk, driver.gait, driver.reference, 0.5,
                         true, Fall::none, tracked);
  const int index = driver.schedule.index_at(driver.time_s);
  EXPECT_EQ(driver.schedule.phase(index).mode, (model::ContactMode{true, false}));
  EXPECT_GT(driver.schedule.end_s(index), driver.time_s);
  EXPECT_LE(driver.schedule.end_s(index), driver.time_s + 0.02);
}

/// The gait's foot lands later than its step time: what was scheduled of the new step is replaced.
TEST(Schedule, ATrackedStepThatBeginsLateIsOnePhase) {
  Driver driver;
  driver.run(kWalk, 3.0);
  const auto update = [&](const TrackedStep& tracked) {
    driver.schedule.update(driver.time_s, driver.time_s + kAhead_s, kWalk, driver.gait, driver.reference, 0.5,
                           true, Fall::none, tracked);
  };
  update({model::kLeft, driver.time_s - 0.305, 0.31});
  driver.time_s += 0.02;  // scheduled 15 ms ago
  update({model::kRight, driver.time_s, 0.31});
  const int index = driver.schedule.index_at(driver.time_s);
  EXPECT_EQ(driver.schedule.phase(index).mode, (model::ContactMode{false, true}));
  EXPECT_EQ(driver.schedule.phase(index - 1).mode, (model::ContactMode{true, false}));
  EXPECT_EQ(driver.schedule.foot_interval(index, model::kRight).start_s, driver.time_s);
}

}  // namespace
}  // namespace stilt::gait
