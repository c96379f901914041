#include "host_tools/simulation/closed_loop/scenario.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace stilt::simulation {
namespace {

TEST(Scenario, APushIsReadWithForceTimesAndPoint) {
  const Push plain = parse_push("40@10+1");
  EXPECT_EQ(plain.force_N, 40.0);
  EXPECT_EQ(plain.start_s, 10.0);
  EXPECT_EQ(plain.duration_s, 1.0);
  EXPECT_EQ(plain.point, PushPoint::hip);
  const Push backward = parse_push("-22.5@0.5+0.25@torso");
  EXPECT_EQ(backward.force_N, -22.5);
  EXPECT_EQ(backward.duration_s, 0.25);
  EXPECT_EQ(backward.point, PushPoint::torso);
}

TEST(Scenario, APushOfAnotherShapeIsRefused) {
  for (const char* text :
       {"", "40", "40@1", "40@1+", "40@1+0", "40@1+-1", "40@-1+1", "x@1+1", "40@1+1@knee", "nan@1+1",
        "40@inf+1", "1e6@1+1", "10001@1+1", "-10001@1+1", "40 @1+1", "40@1+1@"}) {
    EXPECT_THROW((void)parse_push(text), std::invalid_argument) << text;
  }
}

TEST(Scenario, ALaterCommandIsReadWithGaitSpeedAndTime) {
  const TimedCommand walk = parse_timed_command("walk:-0.3@5.5", 0.5);
  EXPECT_EQ(walk.start_s, 5.5);
  EXPECT_EQ(walk.command.kind, gait::GaitKind::walk);
  EXPECT_EQ(walk.command.speed_m_s, -0.3);
  EXPECT_EQ(parse_timed_command("stand@3", 0.5).command.kind, gait::GaitKind::stand);
  EXPECT_EQ(parse_timed_command("walk@3", 0.4).command.speed_m_s, 0.4);
}

TEST(Scenario, ACommandOfAnotherShapeIsRefused) {
  for (const char* text : {"", "walk", "trot@3", "walk:@3", "walk:fast@3", "walk:9@3", "walk@-1", "walk@"}) {
    EXPECT_THROW((void)parse_timed_command(text, 0.5), std::invalid_argument) << text;
  }
}

TEST(Scenario, PushesActFromTheirStartUntilTheirEndAndAddUp) {
  const std::vector<Push> pushes = {{10.0, 1.0, 1.0, PushPoint::hip}, {5.0, 1.5, 1.0, PushPoint::hip}};
  EXPECT_EQ(push_at(pushes, 0.999).force_N, 0.0);
  EXPECT_EQ(push_at(pushes, 1.0).force_N, 10.0);
  EXPECT_EQ(push_at(pushes, 1.7).force_N, 15.0);
  EXPECT_EQ(push_at(pushes, 2.0).force_N, 5.0);
  EXPECT_EQ(push_at(pushes, 2.5).force_N, 0.0);
}

TEST(Scenario, PushesAndCommandsKeepToTheirTicksDespiteRounding) {
  for (const double rate_hz : {1000.0, 700.0, 600.0}) {
    const double tick_s = 1.0 / rate_hz;
    for (int tick = 1; tick < 5000; ++tick) {
      SCOPED_TRACE(testing::Message() << "tick " << tick << " at " << rate_hz << " Hz");
      const double written_s = tick / rate_hz;
      const std::vector<Push> pushes = {{10.0, written_s, 1.0, PushPoint::hip}};
      const auto force_N = [&](int later) { return push_at(pushes, (tick + later) * tick_s).force_N; };
      const int last = static_cast<int>(rate_hz) - 1;
      ASSERT_EQ(force_N(-1), 0.0);
      ASSERT_EQ(force_N(0), 10.0);
      ASSERT_EQ(force_N(last), 10.0);
      ASSERT_EQ(force_N(last + 1), 0.0);
      const std::vector<TimedCommand> commands = {{written_s, {gait::GaitKind::walk, 0.5}}};
      ASSERT_EQ(command_at(commands, (tick - 1) * tick_s).kind, gait::GaitKind::stand);
      ASSERT_EQ(command_at(commands, tick * tick_s).kind, gait::GaitKind::walk);
    }
  }
}

TEST(Scenario, PushesAtTwoPointsAtOnceAreRefused) {
  const Push hip{10.0, 1.0, 1.0, PushPoint::hip};
  EXPECT_THROW(check_pushes({hip, {10.0, 1.5, 1.0, PushPoint::torso}}, 1e-3), std::invalid_argument);
  EXPECT_NO_THROW(check_pushes({hip, {10.0, 2.0, 1.0, PushPoint::torso}}, 1e-3));
  EXPECT_NO_THROW(check_pushes({hip, hip}, 1e-3));
}

/// Such a push could lie between two ticks.
TEST(Scenario, APushShorterThanATickIsRefused) {
  const auto error = [](double duration_s, double tick_s) -> std::string {
    try {
      check_pushes({{10.0, 1.0, duration_s, PushPoint::hip}}, tick_s);
    } catch (const std::invalid_argument& mistake) {
      return mistake.what();
    }
    return "";
  };
  EXPECT_EQ(error(0.0005, 1e-3),
            "--push: 0.0005 s are shorter than a tick, 0.001 s; a push begins and ends with a tick");
  EXPECT_EQ(error(0.0005, 5e-4), "");
  EXPECT_EQ(error(0.001, 1.0 / 1000.0), "");
  EXPECT_EQ(error(0.00142857142, 1.0 / 700.0), "") << "a tick but for rounding";
}

TEST(Scenario, APushBetweenTicksActsThroughAsManyAsItLasts) {
  const double tick_s = 1e-3;
  for (const double start_s : {1.0, 1.0001, 1.00099}) {
    const std::vector<Push> pushes = {{10.0, start_s, 0.003, PushPoint::hip}};
    int ticks = 0;
    for (int tick = 990; tick < 1010; ++tick) ticks += push_at(pushes, tick * tick_s).force_N > 0.0 ? 1 : 0;
    EXPECT_EQ(ticks, 3) << start_s;
  }
}

TEST(Scenario, TheLastCommandGivenIsActive) {
  const std::vector<TimedCommand> commands = {{1.0, {gait::GaitKind::step, 0.0}},
                                              {2.0, {gait::GaitKind::walk, 0.5}}};
  EXPECT_EQ(command_at(commands, 0.5).kind, gait::GaitKind::stand);
  EXPECT_EQ(command_at(commands, 1.0).kind, gait::GaitKind::step);
  EXPECT_EQ(command_at(commands, 7.0).kind, gait::GaitKind::walk);
}

}  // namespace
}  // namespace stilt::simulation
