#include "firmware/commissioning/encoder_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "firmware/commissioning/identify.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/robots/robots.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using testing::Onlooker;
using testing::Wiring;

constexpr std::size_t kHipLeft = 0, kKneeLeft = 1, kHipRight = 2;
constexpr double kHeld_Nm = 10;
constexpr supervisor::SupervisorParameters kShipped;

/// One reading per millisecond.
class Encoder {
 public:
  std::string turn(double position_rad, double velocity_rad_s, double wanted_Nm) {
    const bool same = position_rad == reading_.position_rad && velocity_rad_s == reading_.velocity_rad_s;
    reading_.unchanged_replies = same ? reading_.unchanged_replies + 1 : 0;
    reading_.position_rad = position_rad;
    reading_.velocity_rad_s = velocity_rad_s;
    reading_.time_ns += 1'000'000;
    return watch_.trouble(reading_, wanted_Nm);
  }
  /// Repeats these: how many replies it takes until something is wrong, 0: nothing is.
  int repeats(double velocity_rad_s) {
    constexpr int kMost = 1000;
    for (int reply = 0; reply < kMost; ++reply) {
      if (!turn(0.3, velocity_rad_s, 1).empty()) return reply;
    }
    return 0;
  }

 private:
  hal::JointReading reading_;
  EncoderWatch watch_{kHipRight, kHeld_Nm, kShipped};
};

TEST(EncoderWatch, ARateAtOneAngleIsFrozen) {
  const int bound = kShipped.unchanged_replies_limit;
  EXPECT_EQ(Encoder().repeats(0.16), bound);
  EXPECT_EQ(Encoder().repeats(-0.16), bound);
  EXPECT_EQ(Encoder().repeats(0.14), 0) << "a constant error of the rate";
}

TEST(EncoderWatch, AJointMayStickUntilItsTorqueChangedByMoreThanFrictionHolds) {
  Encoder encoder;
  for (double torque_Nm = 4; torque_Nm > -5.9; torque_Nm -= 0.05) {
    EXPECT_EQ(encoder.turn(0.3, 0, torque_Nm), "") << torque_Nm;
  }
  EXPECT_EQ(encoder.turn(0.3, 0, -6.1),
            "hip_R does not follow: its encoder is frozen, or something holds the joint");
  EXPECT_EQ(encoder.turn(0.301, 0, -6.1), "") << "it moved";
  for (int reply = 0; reply < 100; ++reply) {
    EXPECT_EQ(encoder.turn(0.301, 0, -15.9), "") << "from there on";
  }
}

TEST(EncoderWatch, AJumpIsNamed) {
  Encoder encoder;
  EXPECT_EQ(encoder.turn(2, 0, 0), "") << "the first reading";
  EXPECT_EQ(encoder.turn(2.04, 0, 0), "");
  EXPECT_EQ(encoder.turn(1.9, 0, 0), "the encoder of hip_R jumped by 0.14 rad: look at its cable and magnet");
}

/// Freezes the encoder of a joint, and keeps how the joint moves from then on.
class Freeze {
 public:
  Freeze(HangingRobot& robot, std::size_t joint, std::function<bool(const Freeze&)> when)
      : robot_(robot), joint_(joint), when_(std::move(when)) {
    robot_.each_tick = [this] { look(); };
  }
  ~Freeze() { robot_.each_tick = nullptr; }
  Freeze(const Freeze&) = delete;
  Freeze& operator=(const Freeze&) = delete;

  [[nodiscard]] double angle_rad() const { return robot_.robot.plant().state()[row()]; }
  [[nodiscard]] double speed_rad_s() const { return robot_.robot.plant().state()[model::kPositions + row()]; }
  [[nodiscard]] double time_s() const { return 1e-9 * static_cast<double>(robot_.now_ns()); }
  [[nodiscard]] int ticks() const {
    return ticks_;
  }  ///< until now, those that turn the drivers off among them
  [[nodiscard]] double fastest_rad_s() const { return fastest_rad_s_; }
  [[nodiscard]] double farthest_rad() const { return farthest_rad_; }

 private:
  [[nodiscard]] Eigen::Index row() const { return model::kFirstJoint + static_cast<int>(joint_); }

  void look() {
    if (ticks_ == 0) {
      if (!when_(*this)) return;
      robot_.robot.drivers().driver(joint_).freeze_encoder(true);
      from_rad_ = angle_rad();
    }
    ++ticks_;
    fastest_rad_s_ = std::max(fastest_rad_s_, std::abs(speed_rad_s()));
    farthest_rad_ = std::max(farthest_rad_, std::abs(angle_rad() - from_rad_));
  }

  HangingRobot& robot_;
  std::size_t joint_;
  std::function<bool(const Freeze&)> when_;
  int ticks_ = 0;
  double from_rad_ = 0, fastest_rad_s_ = 0, farthest_rad_ = 0;
};

/// An AK of version 3 that reports as seldom as the configuration takes.
std::vector<std::string> slow_ak() {
  std::vector<std::string> settings = testing::kAkV3;
  for (const char* setting : {"hip_driver.ak_v3_status_rate_hz=100", "knee_driver.ak_v3_status_rate_hz=100",
                              "hardware.longest_reply_lag_s=0.02"}) {
    settings.emplace_back(setting);
  }
  return settings;
}

std::vector<std::vector<std::string>> every_protocol() {
  return {{},
          {"hip_driver.protocol=mit_ak", "knee_driver.protocol=mit_ak",
           "hip_driver.accept_missing_watchdog=true", "knee_driver.accept_missing_watchdog=true"},
          {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"},
          {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive",
           "hip_driver.accept_missing_watchdog=true", "knee_driver.accept_missing_watchdog=true"},
          testing::kAkV3,
          slow_ak()};
}

IdentificationRequest request_of(const HangingRobot& robot) {
  return {.robot = &(*robots::find("amber3m"))->model,
          .kp_Nm_rad = robot.configuration.supervisor.hold_kp_Nm_rad,
          .supervisor = robot.configuration.supervisor,
          .hardware = robot.configuration.hardware};
}

Wiring wiring(const std::vector<std::string>& settings, double friction_Nm) {
  return {.both = settings,
          .robot = {},
          .miswired = {},
          .plant = {"joint_friction_Nm=" + std::to_string(friction_Nm)},
          .angles_known = true};
}

/// A motion, and most ticks until identify is over; its last ten turn the drivers off.
struct Moment {
  const char* name;
  std::vector<std::string> settings;
  std::size_t joint;
  double time_s;
  int most_ticks;
};

class FrozenEncoderInIdentify : public ::testing::TestWithParam<Moment> {};

TEST_P(FrozenEncoderInIdentify, EndsItBeforeTheJointIsFast) {
  const Moment& moment = GetParam();
  HangingRobot robot(wiring(moment.settings, 0));
  Freeze freeze(robot, moment.joint, [&](const Freeze& now) { return now.time_s() >= moment.time_s; });
  Session session = robot.session();
  const auto excitation = excite(session, request_of(robot));
  ASSERT_FALSE(excitation);
  EXPECT_NE(excitation.error().find("frozen"), std::string::npos) << excitation.error();
  EXPECT_GT(freeze.ticks(), 0);
  EXPECT_LT(freeze.ticks(), moment.most_ticks) << excitation.error();
  EXPECT_LT(freeze.fastest_rad_s(), 3) << excitation.error();
}

// Measured: 37 ticks in motion, 62 with replies every 2 ms, 154 where the slowest sweep turns round.
INSTANTIATE_TEST_SUITE_P(Motions, FrozenEncoderInIdentify,
                         ::testing::Values(Moment{"SlowRamp", {}, kHipLeft, 15.37, 41},
                                           Moment{"FastRamp", {}, kHipLeft, 18.11, 41},
                                           Moment{"Sweep", {}, kHipLeft, 29.07, 41},
                                           Moment{"TurnOfTheSweep", {}, kHipLeft, 24.664, 200},
                                           Moment{"KneeOfAnAk", testing::kAkV3, kKneeLeft, 44.74, 70}),
                         [](const auto& row) { return std::string(row.param.name); });

/// Nothing distinguishes it from a joint at rest, and its torque stays as it was.
TEST(FrozenEncoder, OfAHeldJointIsFoundWhenItsTurnComes) {
  HangingRobot robot(wiring({}, 0));
  Freeze freeze(robot, kKneeLeft, [](const Freeze& now) { return now.time_s() >= 18.11; });
  Session session = robot.session();
  const auto excitation = excite(session, request_of(robot));
  ASSERT_FALSE(excitation);
  EXPECT_TRUE(excitation.error().starts_with("knee_L does not follow: its encoder is frozen"))
      << excitation.error();
  EXPECT_LT(freeze.fastest_rad_s(), 3);
  EXPECT_LT(freeze.farthest_rad(), 1);
}

std::expected<JogReport, CommandFailure> jogged(HangingRobot& robot, std::size_t joint, double angle_rad) {
  Session session = robot.session();
  Onlooker person(robot);
  return jog_and_ask(session, robot.jog_request(joint, angle_rad),
                     configuration::driver_of(robot.configuration.hardware, joint), person);
}

TEST(FrozenEncoder, EndsAJogAndIsNamed) {
  for (const std::vector<std::string>& settings : {std::vector<std::string>{}, testing::kAkV3}) {
    HangingRobot robot(wiring(settings, 0));
    Freeze freeze(robot, kHipLeft, [](const Freeze& now) { return now.angle_rad() > 0.1; });
    const auto report = jogged(robot, kHipLeft, 0.3);
    ASSERT_FALSE(report);
    EXPECT_TRUE(report.error().sentence.starts_with("the encoder of hip_L is frozen: it reports 0."))
        << report.error().sentence;
    EXPECT_LT(freeze.ticks(), 70);
    EXPECT_LT(freeze.fastest_rad_s(), 0.5);
    EXPECT_LT(robot.peak_torque_Nm(kHipLeft), 3);
  }
}

TEST(FrozenEncoder, AtTheFarEndOfAJogDoesNotSwingTheLegToItsStop) {
  HangingRobot robot(wiring({}, 0));
  Freeze freeze(robot, kHipLeft,
                [](const Freeze& now) { return now.angle_rad() > 0.27 && now.speed_rad_s() < 0; });
  const auto report = jogged(robot, kHipLeft, 0.3);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().sentence,
            "hip_L does not follow: its encoder is frozen, or something holds the joint");
  EXPECT_LT(freeze.fastest_rad_s(), 2.5);
  EXPECT_LT(freeze.farthest_rad(), 0.6);
}

/// Without noise, its reading repeats whenever it sticks: after each turn of the motion for a fifth of a
/// second.
TEST(StickingJoint, IsHealthyInAJog) {
  for (const std::vector<std::string>& settings : every_protocol()) {
    for (const double angle_rad : {kSmallestJog_rad, 0.3, -0.3}) {
      HangingRobot robot(wiring(settings, 4));
      const auto report = jogged(robot, kHipLeft, angle_rad);
      ASSERT_TRUE(report) << report.error().sentence;
      EXPECT_TRUE(report->motion.completed) << report->verdict.sentence;
    }
  }
}

TEST(StickingJoint, IsHealthyInIdentify) {
  for (const std::vector<std::string>& settings : {std::vector<std::string>{}, slow_ak()}) {
    HangingRobot robot(wiring(settings, 4));
    Session session = robot.session();
    const auto excitation = excite(session, request_of(robot));
    EXPECT_TRUE(excitation) << excitation.error();
  }
}

}  // namespace
}  // namespace stilt::commissioning
