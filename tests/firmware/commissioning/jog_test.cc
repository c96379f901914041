#include "firmware/commissioning/jog.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/configuration/driver_of.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using testing::Onlooker;
using testing::Wiring;

constexpr double kLimit_Nm = 80.0;
constexpr double kAStepOfAFrame_Nm = 0.06;
constexpr std::size_t kHipLeft = 0, kKneeLeft = 1, kHipRight = 2, kKneeRight = 3;

std::expected<JogReport, CommandFailure> jogged(HangingRobot& robot, std::size_t joint, double angle_rad) {
  Session session = robot.session();
  Onlooker person(robot);
  const auto& hardware = robot.configuration.hardware;
  return jog_and_ask(session, robot.jog_request(joint, angle_rad), configuration::driver_of(hardware, joint),
                     person);
}

struct Miswiring {
  const char* what;
  Wiring wiring;
  std::size_t joint;
  Finding finding;
};

/// The robot's settings; those of the commands are the shipped ones.
const std::vector<std::string> kExchangedMotors = {"hip_L.id=2", "hip_L.reply_id=18", "knee_L.id=1",
                                                   "knee_L.reply_id=17"};
const std::vector<std::string> kExchangedLegs = {
    "hip_L.bus=1", "hip_L.id=3", "hip_L.reply_id=19", "knee_L.bus=1", "knee_L.id=4", "knee_L.reply_id=20",
    "hip_R.bus=0", "hip_R.id=1", "hip_R.reply_id=17", "knee_R.bus=0", "knee_R.id=2", "knee_R.reply_id=18"};

const std::vector<Miswiring>& miswirings() {
  static const std::vector<Miswiring> all = {
      {"nothing wrong", {}, kHipLeft, Finding::correct},
      {"nothing wrong", {}, kKneeRight, Finding::correct},
      {"an offset", {{}, {"hip_R.offset_rad=1.5"}, {}}, kHipRight, Finding::correct},
      {"exchanged motors of a leg", {{}, kExchangedMotors, {}}, kHipLeft, Finding::exchanged_motors},
      {"exchanged motors of a leg", {{}, kExchangedMotors, {}}, kKneeLeft, Finding::exchanged_motors},
      {"exchanged legs", {{}, kExchangedLegs, {}}, kHipLeft, Finding::exchanged_legs},
      {"exchanged legs", {{}, kExchangedLegs, {}}, kKneeRight, Finding::exchanged_legs},
      {"reversed joint", {{}, {"hip_L.reversed=true"}, {}}, kHipLeft, Finding::reversed_joint},
      {"reversed joint", {{}, {"knee_R.reversed=false"}, {}}, kKneeRight, Finding::reversed_joint},
      {"reversed motor", {{}, {}, {"motor-reversed:hip_R"}}, kHipRight, Finding::reversed_motor},
      {"reversed motor", {{}, {}, {"motor-reversed:knee_L"}}, kKneeLeft, Finding::reversed_motor},
      {"reversed encoder", {{}, {}, {"encoder-reversed:hip_L"}}, kHipLeft, Finding::reversed_encoder},
      {"reversed encoder", {{}, {}, {"encoder-reversed:knee_R"}}, kKneeRight, Finding::reversed_encoder},
      {"motor and encoder reversed",
       {{}, {}, {"motor-reversed:knee_L", "encoder-reversed:knee_L"}},
       kKneeLeft,
       Finding::reversed_joint},
      {"dead motor", {{}, {}, {"dead:knee_L"}}, kKneeLeft, Finding::dead_joint},
      {"blocked", {{}, {}, {"blocked:hip_L"}}, kHipLeft, Finding::blocked_joint},
      {"dead encoder", {{}, {}, {"encoder-dead:hip_R"}}, kHipRight, Finding::dead_encoder},
      {"dead encoder", {{}, {}, {"encoder-dead:knee_L"}}, kKneeLeft, Finding::dead_encoder},
      {"exchanged encoders", {{}, {}, {"encoder-exchanged:hip_R"}}, kHipRight, Finding::exchanged_encoders},
      {"exchanged encoders", {{}, {}, {"encoder-exchanged:hip_R"}}, kKneeRight, Finding::exchanged_encoders},
      {"half the gear", {{}, {"hip_driver.ratio=2"}, {}}, kHipLeft, Finding::wrong_ratio},
      {"twice the gear",
       {{}, {"knee_driver.ratio=0.5", "supervisor.hold_kd_Nms_rad=1", "supervisor.damping_kd_Nms_rad=1"}, {}},
       kKneeRight,
       Finding::wrong_ratio},
  };
  return all;
}

/// Once in the air, and once with knees that hang at their end stops.
void expect_named(const Miswiring& miswiring, double angle_rad, bool stops) {
  SCOPED_TRACE(miswiring.what + std::string(", joint ") + std::to_string(miswiring.joint) + ", to " +
               std::to_string(angle_rad) + (stops ? ", with end stops" : ""));
  Wiring wiring = miswiring.wiring;
  if (stops) wiring.plant = {"joint_stops=1"};
  HangingRobot robot(wiring);
  const auto report = jogged(robot, miswiring.joint, angle_rad);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_STREQ(name(report->verdict.finding), name(miswiring.finding)) << report->verdict.sentence;
  EXPECT_EQ(nlohmann::json::parse(to_json(*report)).at("good"), miswiring.finding == Finding::correct);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_LT(robot.peak_torque_Nm(joint), kJogTorqueShare * kLimit_Nm + kAStepOfAFrame_Nm);
  }
}

TEST(Jog, NamesEveryMistakeOfTheWiringWithLessThanAFifthOfTheTorque) {
  for (const Miswiring& miswiring : miswirings()) {
    for (const double angle_rad : {0.3, -0.3}) {
      for (const bool stops : {false, true}) expect_named(miswiring, angle_rad, stops);
    }
  }
}

/// Nothing reports that the leg moves: a straight knee cannot bend the other way.
TEST(Jog, ALegWhoseEncoderIsDeadDoesNotSwingFar) {
  for (const double angle_rad : {0.3, -0.3}) {
    HangingRobot robot(
        {.both = {}, .robot = {}, .miswired = {"encoder-dead:hip_L"}, .plant = {"joint_stops=1"}});
    const auto report = jogged(robot, kHipLeft, angle_rad);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_EQ(report->verdict.finding, Finding::dead_encoder) << report->verdict.sentence;
    EXPECT_LT(robot.sighting().angle_rad.value(), 0.5) << angle_rad;
    EXPECT_LT(robot.peak_torque_Nm(kHipLeft), 5.0) << angle_rad;
  }
}

TEST(Jog, ALegWithFrictionWhoseEncoderIsDeadDoesNotSwingToItsStop) {
  for (const double angle_rad : {0.3, -0.3}) {
    HangingRobot robot({.both = {},
                        .robot = {},
                        .miswired = {"encoder-dead:hip_L"},
                        .plant = {"joint_stops=1", "joint_friction_Nm=5"}});
    const auto report = jogged(robot, kHipLeft, angle_rad);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_EQ(report->verdict.finding, Finding::dead_encoder) << report->verdict.sentence;
    EXPECT_LT(robot.sighting().angle_rad.value(), 0.5) << angle_rad;
  }
}

TEST(Jog, AJointAtItsStopGoesTheOtherWay) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {}, .plant = {"joint_stops=1"}});
  const auto report = jogged(robot, kKneeLeft, -0.3);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_EQ(report->verdict.finding, Finding::correct);
  EXPECT_EQ(report->motion.direction, 1);
  EXPECT_NEAR(report->motion.reached_rad, 0.3, 0.03);
  EXPECT_NE(to_text(*report).find("so it went the other way"), std::string::npos);
}

/// A person straightens the legs and lets go of them.
void straighten(HangingRobot& robot) {
  robot_on_bus::Hands& hands = robot.robot.hands();
  for (int joint = 0; joint < model::kJoints; ++joint) hands.move(model::kFirstJoint + joint, 0);
  static_cast<void>(robot.sleep_until(robot.now_ns() + 5'000'000'000));
  hands.let_go();
}

TEST(Jog, FrictionOfAnOrdinaryGearNeedsNoSecondPush) {
  for (const std::size_t joint : {kHipLeft, kKneeLeft}) {
    HangingRobot robot({.both = {}, .robot = {}, .miswired = {}, .plant = {"joint_friction_Nm=1"}});
    straighten(robot);
    const auto report = jogged(robot, joint, 0.3);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_EQ(report->verdict.finding, Finding::correct) << report->verdict.sentence;
    EXPECT_LE(report->motion.breakaway_Nm, robot.jog_request(joint, 0.3).push_Nm);
    EXPECT_EQ(report->motion.direction, 1) << joint;
  }
}

TEST(Jog, ARabbitIsCorrect) {
  for (const std::size_t joint : {kHipLeft, kKneeLeft, kHipRight, kKneeRight}) {
    for (const double angle_rad : {0.3, -0.3}) {
      HangingRobot robot({.both = {}, .robot = {}, .miswired = {}, .name = "rabbit"});
      const auto report = jogged(robot, joint, angle_rad);
      ASSERT_TRUE(report) << report.error().sentence;
      EXPECT_EQ(report->verdict.finding, Finding::correct) << report->verdict.sentence;
    }
  }
}

TEST(Jog, AJointThatIsFastGetsNoTorque) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {}, .plant = {"encoder_velocity_noise_rad_s=3"}});
  const auto report = jogged(robot, kHipLeft, 0.3);
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().sentence.ends_with("turns too fast")) << report.error().sentence;
  EXPECT_LT(robot.peak_torque_Nm(kHipLeft), 0.12) << "before the push";
}

TEST(Jog, WorksWithDriversOfEveryProtocol) {
  const std::vector<std::vector<std::string>> protocols = {
      {"hip_driver.protocol=mit_ak", "knee_driver.protocol=mit_ak", "hip_driver.accept_missing_watchdog=true",
       "knee_driver.accept_missing_watchdog=true"},
      testing::kAkV3,
      {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"},
      {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive", "hip_driver.accept_missing_watchdog=true",
       "knee_driver.accept_missing_watchdog=true"}};
  for (const std::vector<std::string>& settings : protocols) {
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {"motor-reversed:knee_R"}});
    const auto right = jogged(robot, kHipLeft, 0.3);
    ASSERT_TRUE(right) << settings[0] << ": " << right.error().sentence;
    EXPECT_EQ(right->verdict.finding, Finding::correct) << settings[0] << right->verdict.sentence;
    EXPECT_NEAR(right->motion.velocity_factor, 1, 0.05) << settings[0];
    HangingRobot little({.both = settings, .robot = {}, .miswired = {}});
    const auto smallest = jogged(little, kKneeLeft, kSmallestJog_rad);
    ASSERT_TRUE(smallest) << settings[0] << ": " << smallest.error().sentence;
    EXPECT_EQ(smallest->verdict.finding, Finding::correct) << settings[0] << smallest->verdict.sentence;
    HangingRobot again({.both = settings, .robot = {}, .miswired = {"motor-reversed:knee_R"}});
    const auto reversed = jogged(again, kKneeRight, 0.3);
    ASSERT_TRUE(reversed) << settings[0] << ": " << reversed.error().sentence;
    EXPECT_EQ(reversed->verdict.finding, Finding::reversed_motor) << settings[0];
  }
}

TEST(Jog, TheOtherJointsAreLimp) {
  HangingRobot robot;
  const auto report = jogged(robot, kKneeLeft, 0.2);
  ASSERT_TRUE(report);
  for (const std::size_t joint : {kHipLeft, kHipRight, kKneeRight}) {
    EXPECT_LE(robot.peak_torque_Nm(joint), kAStepOfAFrame_Nm);
  }
}

TEST(Jog, GoesToTheAngleAndBack) {
  HangingRobot robot;
  const auto report = jogged(robot, kHipLeft, -0.2);
  ASSERT_TRUE(report);
  EXPECT_NEAR(report->motion.reached_rad, -0.2, 0.03);
  EXPECT_TRUE(report->motion.completed);
  EXPECT_NEAR(robot.sighting().angle_rad.value(), 0.2, 0.03);
}

TEST(Jog, AJointThatDoesNotMoveGetsAFifthOfItsTorqueAndNoMore) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {"dead:hip_L"}});
  const auto report = jogged(robot, kHipLeft, 0.3);
  ASSERT_TRUE(report);
  EXPECT_LE(report->motion.peak_torque_Nm, kJogTorqueShare * kLimit_Nm);
  EXPECT_NEAR(report->motion.breakaway_Nm, kJogTorqueShare * kLimit_Nm, 1e-9);
}

TEST(Jog, AnEmergencyStopThatIsSilentIsNotOverlooked) {
  HangingRobot robot({.both = {}, .robot = {"torso_sensor.emergency_stop_released=none"}, .miswired = {}});
  const auto report = jogged(robot, kHipLeft, 0.2);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().sentence, "emergency stop is silent");
  EXPECT_LT(robot.peak_torque_Nm(kHipLeft), 0.06) << "before any torque";
}

std::string refused_with(HangingRobot& robot, const DriverLimits& limits) {
  Session session = robot.session(limits);
  EXPECT_TRUE(session.bring_up());
  const auto motion = jog(session, robot.jog_request(kHipLeft, 0.2));
  EXPECT_LT(robot.peak_torque_Nm(kHipLeft), 0.06) << "before any torque";
  return motion ? "" : motion.error();
}

TEST(Jog, AHotDriverGetsNoTorque) {
  HangingRobot robot;
  EXPECT_NE(refused_with(robot, {.overheated_C = 20}).find(" C, and supervisor.overheated_C is 20"),
            std::string::npos);
}

TEST(Jog, ADriverWhoseSupplyIsOutOfRangeGetsNoTorque) {
  HangingRobot robot(
      {.both = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"}, .robot = {}, .miswired = {}});
  const DriverLimits low{.low_voltage_V = 100, .high_voltage_V = 200},
      high{.low_voltage_V = 1, .high_voltage_V = 2};
  EXPECT_NE(refused_with(robot, low).find("supervisor.low_voltage_V to high_voltage_V are 100 to 200"),
            std::string::npos);
  EXPECT_NE(refused_with(robot, high).find(" V, and supervisor.low_voltage_V"), std::string::npos);
}

TEST(Jog, AMoteusWithTheEncoderOfItsRotorAloneIsMoved) {
  HangingRobot robot(
      {.both = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus"}, .robot = {}, .miswired = {}});
  robot.reference_to_rotors();
  const auto report = jogged(robot, kKneeRight, 0.3);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_EQ(report->verdict.finding, Finding::correct);
}

TEST(Jog, AStopDuringTheMotionEndsIt) {
  HangingRobot robot;
  Session session = robot.session();
  ASSERT_TRUE(session.bring_up());
  robot.stop = true;
  const auto motion = jog(session, robot.jog_request(kHipLeft, 0.2));
  ASSERT_FALSE(motion);
  EXPECT_EQ(motion.error(), "stopped");
}

/// An AK of version 3 goes on with the last torque meanwhile.
TEST(Jog, AStallWithTorqueEndsItLimp) {
  for (const std::int64_t stall_ns : {5'000'000, 100'000'000}) {
    HangingRobot robot({.both = testing::kAkV3, .robot = {}, .miswired = {}});
    testing::stall_with_torque(robot, stall_ns);
    Session session = robot.session({.stall_s = 0.01});
    ASSERT_TRUE(session.bring_up());
    const auto motion = jog(session, robot.jog_request(kHipLeft, 0.2));
    if (stall_ns < 10'000'000) {
      EXPECT_TRUE(motion) << motion.error();
      continue;
    }
    ASSERT_FALSE(motion);
    EXPECT_TRUE(motion.error().starts_with("the loop stood still for 0.101 s")) << motion.error();
    static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
    EXPECT_LT(robot.robot.plant().applied_torque_Nm().cwiseAbs().maxCoeff(), kAStepOfAFrame_Nm);
  }
}

/// Answers that somebody wrote down before.
class Written final : public Person {
 public:
  explicit Written(std::vector<std::string> answers) : answers_(std::move(answers)) {}
  void ask(const std::string& /*question*/) override {}
  std::optional<std::string> answer() override {
    if (answers_.empty()) return std::nullopt;
    std::string first = answers_.front();
    answers_.erase(answers_.begin());
    return first;
  }
  bool gone() const override { return answers_.empty(); }
  bool patient() const override { return false; }

 private:
  std::vector<std::string> answers_;
};

TEST(Jog, AWrongAnswerIsRefusedWithTheQuestion) {
  for (const auto& [answers, part] :
       {std::pair<std::vector<std::string>, std::string>{{"banana"},
                                                         "\"banana\" is no answer to: Which link"},
        {{"left thigh", "up"}, "\"up\" is no answer to: Which way"},
        {{"left thigh", "backward", "-5"}, "\"-5\" is no answer to: By how many"},
        {{"left thigh"}, "no answer to: Which way"}}) {
    HangingRobot robot;
    Session session = robot.session();
    Written person(answers);
    const auto report = jog_and_ask(session, robot.jog_request(kHipLeft, 0.1), {}, person);
    ASSERT_FALSE(report);
    EXPECT_TRUE(report.error().bad_answer);
    EXPECT_TRUE(report.error().sentence.starts_with(part)) << report.error().sentence;
  }
}

/// Remembers the torque of each question.
class Careful final : public Person {
 public:
  explicit Careful(const HangingRobot& robot) : robot_(robot) {}
  void ask(const std::string& question) override {
    questions.push_back(question);
    peaks_Nm.push_back(robot_.peak_torque_Nm(kHipLeft));
  }
  std::optional<std::string> answer() override { return "none"; }
  bool gone() const override { return false; }
  bool patient() const override { return false; }

  std::vector<std::string> questions;
  std::vector<double> peaks_Nm;

 private:
  const HangingRobot& robot_;
};

TEST(Jog, ThePersonIsAskedBeforeTheTorqueDoubles) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {"blocked:hip_L"}});
  Session session = robot.session();
  Careful person(robot);
  const JogRequest request = robot.jog_request(kHipLeft, 0.3);
  const auto report = jog_and_ask(session, request, {}, person);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict.finding, Finding::blocked_joint) << report->verdict.sentence;
  double bound_Nm = request.push_Nm;
  for (const double peak_Nm : person.peaks_Nm) {
    EXPECT_NEAR(peak_Nm, std::min(bound_Nm, kJogTorqueShare * kLimit_Nm), kAStepOfAFrame_Nm);
    bound_Nm *= 2;
  }
  ASSERT_EQ(person.questions.size(), 4u);
  EXPECT_TRUE(
      person.questions.front().ends_with("No encoder moved with 3.9 Nm either way; none doubles the torque"))
      << person.questions.front();
  EXPECT_TRUE(person.questions.back().ends_with("No encoder moved with 16.0 Nm either way"))
      << person.questions.back();
}

TEST(Jog, TheRobotIsOffWhenTheAnswersAreGiven) {
  HangingRobot robot;
  ASSERT_TRUE(jogged(robot, kHipLeft, 0.1));
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
  }
}

}  // namespace
}  // namespace stilt::commissioning
