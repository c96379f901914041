#include <gtest/gtest.h>
#include <stilt/controller.h>
#include <stilt/simulated_robot.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/library/read_settings.h"
#include "firmware/realtime/allocation_counter.h"
#include "tests/own_folder.h"

namespace stilt {
namespace {

/// A controller and its simulated robot, tick by tick.
class Loop {
 public:
  explicit Loop(const Settings& settings = {})
      : controller(*Controller::create(settings)), robot(*SimulatedRobot::create({})) {}

  void begin_standing() { controller.begin_standing(controller.tick_period_ns(), robot.read()); }

  /// Runs for a time; `change` may change what the sensors report.
  const Tick& run(double seconds, const std::function<void(Measurements&)>& change = [](Measurements&) {}) {
    const std::int64_t tick_ns = controller.tick_period_ns();
    const auto end = ticks + std::llround(1e9 * seconds / static_cast<double>(tick_ns));
    const Tick* done = nullptr;
    do {
      Measurements measurements = robot.read();
      change(measurements);
      const realtime::AllocationScope scope;
      done = &controller.tick((ticks + 1) * tick_ns, measurements);
      if (ticks % (controller.plan_period_ns() / tick_ns) == 0) controller.plan();
      allocations += scope.count();
      robot.drive(*done);
      robot.advance();
    } while (++ticks < end);
    return *done;
  }

  Controller controller;
  SimulatedRobot robot;
  long long ticks = 0;
  long long allocations = 0;
};

TEST(OwnLoop, ARobotThatStandsWalksAtTheSpeedAskedForWithoutAllocating) {
  Loop loop;
  loop.begin_standing();
  loop.controller.request(Motion::walk, 0.3);
  EXPECT_STREQ(loop.run(4.0).state, "walk");
  const double start_x_m = loop.robot.hip_x_m();
  const Tick& end = loop.run(5.0);
  EXPECT_NEAR((loop.robot.hip_x_m() - start_x_m) / 5.0, 0.3, 0.03);
  EXPECT_TRUE(end.follows_plan);
  EXPECT_STREQ(end.fallback_level, "plan");
  EXPECT_STREQ(end.fault, "");
  EXPECT_NEAR(end.estimated_state[1], loop.robot.state()[1], 0.02);
  EXPECT_EQ(loop.allocations, 0);
}

TEST(OwnLoop, ASpeedBeyondTheLimitIsCutAndOneThatIsNotANumberIsZero) {
  const auto mean_speed_m_s = [](double asked_m_s) {
    Loop loop;
    loop.begin_standing();
    loop.controller.request(Motion::walk, 0.5);
    loop.run(2.0);
    loop.controller.request(Motion::walk, asked_m_s);
    loop.run(3.0);
    const double start_x_m = loop.robot.hip_x_m();
    const Tick& end = loop.run(2.0);
    EXPECT_STREQ(end.state, "walk") << asked_m_s;
    EXPECT_STREQ(end.fault, "") << asked_m_s;
    return (loop.robot.hip_x_m() - start_x_m) / 2.0;
  };
  EXPECT_NEAR(mean_speed_m_s(5.0), 0.8, 0.05) << "telemetry.speed_limit_m_s";
  EXPECT_NEAR(mean_speed_m_s(-5.0), -0.8, 0.05);
  EXPECT_NEAR(mean_speed_m_s(kNotMeasured), 0.0, 0.05);
}

/// As docs/library.md allows. The ticks wait for plans, so that a busy machine changes nothing: ten ticks run
/// while a plan is made.
TEST(OwnLoop, TicksPlansAndRequestsEachFromAThreadOfItsOwn) {
  Loop loop;
  loop.begin_standing();
  std::atomic<long long> ticks = 0, planned = 0;
  std::atomic<bool> has_ended = false;
  std::thread planner([&] {
    while (!has_ended) {
      const long long from = ticks;
      loop.controller.plan();
      planned = from;
    }
  });
  std::thread hand([&] {
    for (const long long at : {500, 2500, 4500}) {
      while (!has_ended && ticks < at) std::this_thread::yield();
      loop.controller.request(Motion::walk, 1e-4 * static_cast<double>(at));
    }
  });
  double start_x_m = 0.0;
  std::string fault;
  while (fault.empty() && ticks < 8000) {
    while (ticks > planned + 10) std::this_thread::yield();
    const Tick& done =
        loop.controller.tick((ticks + 1) * loop.controller.tick_period_ns(), loop.robot.read());
    fault = done.fault;
    loop.robot.drive(done);
    loop.robot.advance();
    if (++ticks == 6000) start_x_m = loop.robot.hip_x_m();
  }
  has_ended = true;
  planner.join();
  hand.join();
  EXPECT_EQ(fault, "");
  EXPECT_NEAR((loop.robot.hip_x_m() - start_x_m) / 2.0, 0.45, 0.05);
}

TEST(OwnLoop, ItAsksForTheDriversAndWaitsForThem) {
  Loop loop;
  EXPECT_STREQ(loop.run(0.1).state, "idle");
  loop.controller.request(Motion::enable);
  const auto off = [](Measurements& measurements) { measurements.drivers_enabled = false; };
  const Tick waiting = loop.run(0.2, off);
  EXPECT_EQ(waiting.action, DriverAction::enable);
  EXPECT_STREQ(waiting.state, "calibrate");
  const Tick ready = loop.run(0.1);
  EXPECT_STREQ(ready.state, "ready");
  EXPECT_EQ(ready.action, DriverAction::targets);
  EXPECT_EQ(ready.targets[0].kp_Nm_rad, 0.0) << "damped";
  loop.controller.request(Motion::cut);
  EXPECT_EQ(loop.run(0.002).action, DriverAction::disable);
}

TEST(OwnLoop, AnEmergencyStopDampsTheJointsAndHasAName) {
  Loop loop;
  loop.begin_standing();
  loop.run(0.5);
  const Tick stopped = loop.run(0.05, [](Measurements& measurements) { measurements.emergency_stop = true; });
  EXPECT_STREQ(stopped.state, "fault");
  ASSERT_EQ(stopped.action, DriverAction::targets);
  EXPECT_EQ(stopped.targets[1].kp_Nm_rad, 0.0);
  EXPECT_GT(stopped.targets[1].kd_Nms_rad, 0.0);
  EXPECT_STREQ(stopped.fault, "emergency_stop");
}

TEST(OwnLoop, AJointThatIsNotMeasuredIsAFault) {
  Loop loop;
  loop.begin_standing();
  loop.run(0.5);
  const Tick& silent =
      loop.run(0.1, [](Measurements& measurements) { measurements.joints[1].position_rad = kNotMeasured; });
  EXPECT_STRNE(silent.fault, "");
  EXPECT_STREQ(silent.state, "fault");
}

TEST(OwnLoop, OneReadingThatIsMissingIsNoFaultAndMoreAre) {
  constexpr double kWrong[] = {kNotMeasured, std::numeric_limits<double>::infinity()};
  using Reading = std::function<double&(Measurements&)>;
  const std::pair<Reading, const char*> readings[] = {
      {[](Measurements& m) -> double& { return m.joints[1].position_rad; }, "missed_replies"},
      {[](Measurements& m) -> double& { return m.joints[1].velocity_rad_s; }, "missed_replies"},
      {[](Measurements& m) -> double& { return m.pitch_rad; }, "stale_torso_sensor"},
      {[](Measurements& m) -> double& { return m.pitch_rate_rad_s; }, "stale_torso_sensor"}};
  for (const auto& [reading, fault] : readings) {
    for (const double wrong : kWrong) {
      const auto spoil = [&read = reading, wrong](Measurements& measurements) { read(measurements) = wrong; };
      Loop loop;
      loop.begin_standing();
      loop.controller.request(Motion::walk, 0.3);
      loop.run(1.0);
      loop.run(1e-3, spoil);
      const Tick& after = loop.run(0.2);
      EXPECT_STREQ(after.state, "walk");
      EXPECT_STREQ(after.fault, "");
      EXPECT_STREQ(loop.run(0.02, spoil).fault, fault) << wrong;
    }
  }
}

TEST(OwnLoop, ATorsoThatIsNotMeasuredIsAFault) {
  Loop loop;
  loop.begin_standing();
  loop.run(0.5);
  const Tick& silent =
      loop.run(0.1, [](Measurements& measurements) { measurements.pitch_rad = kNotMeasured; });
  EXPECT_STRNE(silent.fault, "");
}

/// Walks with a reading of the torso in one tick of `period_ticks`.
/// @return  the first fault; "" after `seconds` without one
std::string fault_with_torso_every(int period_ticks, const Settings& settings, double seconds = 3.0) {
  Loop loop(settings);
  loop.begin_standing();
  loop.controller.request(Motion::walk, 0.3);
  const auto leave_gaps = [&loop, period_ticks](Measurements& measurements) {
    if (loop.ticks % period_ticks != 0) measurements.pitch_rad = measurements.pitch_rate_rad_s = kNotMeasured;
  };
  for (double time_s = 0; time_s < seconds; time_s += 1e-3) {
    const Tick& tick = loop.run(1e-3, leave_gaps);
    if (*tick.fault != '\0') return tick.fault;
  }
  EXPECT_STREQ(loop.run(1e-3, leave_gaps).state, "walk");
  return "";
}

TEST(OwnLoop, ATorsoSlowerThanTheTicksIsMissedOnceItsReadingIsDue) {
  EXPECT_EQ(fault_with_torso_every(4, {.settings = {"torso_sensor.rate_hz=250"}}), "");
  EXPECT_EQ(fault_with_torso_every(5, {.settings = {"torso_sensor.rate_hz=200"}}), "");
  EXPECT_EQ(fault_with_torso_every(5, {.settings = {"torso_sensor.rate_hz=1000"}}), "missed_replies");
  EXPECT_EQ(fault_with_torso_every(8, {.settings = {"torso_sensor.rate_hz=200"}}), "missed_replies");
}

TEST(OwnLoop, APlanIsMadeOncePerTickAndOnlyOnTheFeet) {
  Loop loop;
  EXPECT_FALSE(loop.controller.plan()) << "before the first tick";
  loop.begin_standing();
  loop.run(0.003);
  static_cast<void>(
      loop.controller.tick((loop.ticks + 1) * loop.controller.tick_period_ns(), loop.robot.read()));
  EXPECT_TRUE(loop.controller.plan());
  EXPECT_FALSE(loop.controller.plan()) << "from the same state";
}

TEST(OwnLoop, WhatIsWrongIsASentence) {
  const auto controller = Controller::create({.settings = {"gait.swing_height_m=9"}});
  ASSERT_FALSE(controller);
  EXPECT_NE(controller.error().find("gait.swing_height_m"), std::string::npos) << controller.error();
  const Settings too_high = {.settings = {"reference.base_height_m=0.9"}};
  for (const auto& refused :
       {Controller::create(too_high).error(), SimulatedRobot::create(too_high).error()}) {
    EXPECT_TRUE(refused.starts_with("amber3m: reference.base_height_m = 0.9 ")) << refused;
  }
  EXPECT_FALSE(Controller::create({.robot = "/nowhere/mine.urdf"}));
  EXPECT_FALSE(Controller::create({.configuration_file = "/nowhere/mine.toml"}));
  const auto robot = SimulatedRobot::create({}, {"friction=-1"});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error(), "plant: friction=-1: friction must be a number from 0.01 to 5");
  const Settings nameless = {.robot = "mine"};
  for (const auto& refused :
       {Controller::create(nameless).error(), SimulatedRobot::create(nameless).error()}) {
    EXPECT_TRUE(refused.starts_with("Settings::robot: there is no robot \"mine\"")) << refused;
  }
}

TEST(OwnLoop, TheRobotOfAFileNeedsNoOtherName) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "[hardware]\nrobot = \"rabbit\"\n[reference]\nbase_height_m = 0.9\n";
  const auto refused = Controller::create({.configuration_file = file});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("legs of 0.4 m"), std::string::npos) << refused.error();
}

TEST(OwnLoop, EachSeedOfTheSimulatedRobotHasItsOwnNoise) {
  const auto measured_rad = [](std::uint64_t seed) {
    SimulatedRobot robot = *SimulatedRobot::create({}, {"encoder_noise_rad=0.001"}, seed);
    return robot.read().joints[0].position_rad;
  };
  EXPECT_EQ(measured_rad(1), measured_rad(1));
  EXPECT_NE(measured_rad(1), measured_rad(2));
}

TEST(OwnLoop, ADisabledDriverOfTheSimulatedRobotGivesNoTorque) {
  SimulatedRobot robot = *SimulatedRobot::create({});
  const auto torque_Nm = [&robot](const Tick& tick) {
    robot.drive(tick);
    robot.advance();
    return robot.read().joints[0].torque_Nm;
  };
  Tick tick;
  tick.action = DriverAction::enable;
  static_cast<void>(torque_Nm(tick));
  tick.action = DriverAction::targets;
  tick.targets.fill({.torque_Nm = 5.0, .torque_limit_Nm = 50.0});
  EXPECT_NEAR(torque_Nm(tick), 5.0, 1e-9);
  tick.action = DriverAction::none;
  EXPECT_NEAR(torque_Nm(tick), 5.0, 1e-9) << "until the next call";
  tick.action = DriverAction::disable;
  EXPECT_EQ(torque_Nm(tick), 0.0);
}

TEST(OwnLoop, TheSameCallsGiveTheSameWalk) {
  const auto walk = [] {
    Loop loop;
    loop.begin_standing();
    loop.controller.request(Motion::walk, 0.5);
    loop.robot.push(10.0);
    loop.run(2.0);
    return loop.robot.state();
  };
  EXPECT_EQ(walk(), walk());
}

/// What a motion leads to, tick by tick.
class MotionTest : public ::testing::Test {
 protected:
  /// Asks for a motion.
  /// @return  states up to `end`, as "step stand"; a fault in place of them
  std::string states_after(Motion motion, const std::string& end, double longest_s) {
    loop.controller.request(motion);
    std::string states, state;
    for (double time_s = 0; state != end && time_s < longest_s; time_s += 1e-3) {
      last = loop.run(1e-3);
      if (*last.fault != '\0') return last.fault;
      if (last.state == state) continue;
      state = last.state;
      states += (states.empty() ? "" : " ") + state;
    }
    return states;
  }

  Loop loop{Settings{.settings = {"supervisor.damped_before_off_s=0.05"}}};
  Tick last;
};

TEST(OwnLoop, PlansAroundGaitsHaveTheirTimesAndWeightsUnlessTheUserSetsOthers) {
  const auto read = [](std::vector<std::string> settings) {
    settings.emplace_back("controller.reference=hzd");
    return library::read_settings({.settings = std::move(settings)}).value();
  };
  const configuration::Configuration gaits = read({});
  EXPECT_NEAR(gaits.gait.single_support_s, 0.3, 1e-6);
  EXPECT_EQ(gaits.cost.terminal, 10.0);
  EXPECT_FALSE(gaits.cost.terminal_feet);
  EXPECT_EQ(read({"cost.terminal=3"}).cost.terminal, 3.0);
  const auto slow =
      library::read_settings({.settings = {"controller.reference=hzd", "gait.single_support_s=0.5"}});
  ASSERT_FALSE(slow.has_value());
  EXPECT_TRUE(slow.error().starts_with("controller.reference is hzd: gait.single_support_s = 0.5 must be"))
      << slow.error();
  const auto refused = library::read_settings({.robot = "rabbit", .settings = {"controller.reference=hzd"}});
  ASSERT_FALSE(refused.has_value());
  EXPECT_TRUE(refused.error().starts_with("controller.reference is hzd: no gaits of rabbit"))
      << refused.error();
}

TEST_F(MotionTest, OfARobotOnTheGantryAreThoseOfTheDocument) {
  loop.run(0.01);
  EXPECT_EQ(states_after(Motion::enable, "ready", 0.1), "calibrate ready");
  EXPECT_EQ(states_after(Motion::stand, "stand", 0.1), "stand");
}

TEST_F(MotionTest, StepsStandsAndSits) {
  loop.begin_standing();
  loop.run(0.1);
  EXPECT_EQ(states_after(Motion::step, "step", 0.1), "step");
  loop.run(0.5);
  EXPECT_EQ(states_after(Motion::stand, "stand", 3.0), "step stand");
  loop.run(0.5);
  EXPECT_EQ(states_after(Motion::sit, "sit", 1.0), "stand sit");
}

TEST_F(MotionTest, OffIsByWayOfSittingWhereTheRobotStands) {
  loop.run(0.01);
  EXPECT_EQ(states_after(Motion::enable, "ready", 0.1), "calibrate ready");
  EXPECT_EQ(states_after(Motion::off, "off", 0.1), "ready off") << "the joints are damped first";
  EXPECT_EQ(last.action, DriverAction::disable);
  Loop standing;
  standing.begin_standing();
  standing.run(0.1);
  standing.controller.request(Motion::off);
  EXPECT_STREQ(standing.run(0.1).state, "sit");
}

TEST_F(MotionTest, AResetEndsAFaultWhoseCauseIsGone) {
  loop.begin_standing();
  loop.run(0.1);
  loop.run(0.01, [](Measurements& measurements) { measurements.emergency_stop = true; });
  EXPECT_STREQ(loop.run(0.01).state, "fault");
  loop.controller.request(Motion::reset);
  const Tick& after = loop.run(0.1);
  EXPECT_STREQ(after.state, "idle");
  EXPECT_STREQ(after.fault, "");
}

}  // namespace
}  // namespace stilt
