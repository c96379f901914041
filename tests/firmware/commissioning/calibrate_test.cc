#include "firmware/commissioning/calibrate.h"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "tests/firmware/commissioning/helper.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using testing::Helper;

constexpr double kAsFarAsAHandHolds_rad = 0.02;

std::expected<CalibrationReport, CommandFailure> tried(HangingRobot& robot, Person& person,
                                                       Reference reference = Reference::stops) {
  Session session = robot.session();
  return calibrate(session, testing::calibration_request(robot, reference), person);
}

/// The configuration that a person has after writing the values down.
configuration::Configuration with(const HangingRobot& robot, const CalibrationReport& report) {
  const std::string before = configuration::to_toml(robot.configuration, "");
  const auto text = configuration::with_values(before, "robot.toml", report.values);
  EXPECT_TRUE(text);
  const auto result = configuration::parse(*text, "robot.toml");
  EXPECT_TRUE(result) << configuration::to_string(result.error());
  return *result;
}

const std::vector<std::string> kSigns = {"knee_L.reversed=true", "hip_R.reversed=false"};
const std::vector<std::string> kUnknown = {"hip_L.offset_rad=0.4", "knee_L.offset_rad=-0.6",
                                           "hip_R.offset_rad=-0.9"};

void expect_offsets(const HangingRobot& robot, const CalibrationReport& report,
                    const std::vector<std::string>& of_the_robot) {
  ASSERT_TRUE(report.good()) << to_text(report);
  std::vector<configuration::Override> overrides;
  for (const std::string& setting : of_the_robot) overrides.push_back({setting});
  const auto truth = configuration::load_robot("amber3m", overrides);
  const configuration::Configuration found = with(robot, report);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_EQ(found.hardware.joint[joint].reversed, robot.configuration.hardware.joint[joint].reversed);
    EXPECT_NEAR(found.hardware.joint[joint].offset_rad, truth->hardware.joint[joint].offset_rad,
                kAsFarAsAHandHolds_rad)
        << joint;
  }
}

TEST(Calibrate, FindsOffsetsAtEndStopsAndAtMarksWhateverTheSigns) {
  for (const Reference reference : {Reference::stops, Reference::marks}) {
    SCOPED_TRACE(reference == Reference::stops ? "stops" : "marks");
    HangingRobot robot({.both = kSigns, .robot = kUnknown, .miswired = {}});
    Helper person(robot);
    const auto report = tried(robot, person, reference);
    ASSERT_TRUE(report) << report.error().sentence;
    expect_offsets(robot, *report, kUnknown);
    EXPECT_EQ(report->joints[1].finding, CalibrationFinding::changed);
    EXPECT_EQ(report->joints[3].finding, CalibrationFinding::correct) << report->joints[3].sentence;
  }
}

/// The stops of a hip are symmetric: nothing but the sign shows that forward was taken for backward.
TEST(Calibrate, AJointThatTurnsAgainstItsSignIsNotWritten) {
  for (const Reference reference : {Reference::stops, Reference::marks}) {
    SCOPED_TRACE(reference == Reference::stops ? "stops" : "marks");
    HangingRobot robot;
    Helper person(robot);
    person.exchanges_ways = true;
    const auto report = tried(robot, person, reference);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_FALSE(report->good()) << to_text(*report);
    EXPECT_EQ(report->joints[0].finding, CalibrationFinding::other_sign) << report->joints[0].sentence;
    EXPECT_EQ(report->joints[0].sentence,
              "hip_L turned against its sign: forward and backward were exchanged, or hip_L.reversed must be "
              "true; jog hip_L, change what the jog says, and calibrate again");
    EXPECT_EQ(report->joints[1].finding, CalibrationFinding::correct) << "it cannot bend the other way";
    EXPECT_TRUE(report->values.empty());
    EXPECT_EQ(report->torso.finding, TorsoFinding::not_tried) << "the left hip is its reference";
  }
}

TEST(Calibrate, AWrongSignOfTheConfigurationIsNamed) {
  HangingRobot robot({.both = {}, .robot = {"knee_R.reversed=false"}, .miswired = {}});
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_EQ(report->joints[3].finding, CalibrationFinding::other_sign) << report->joints[3].sentence;
  EXPECT_FALSE(report->joints[3].reversed) << "by the poses";
  EXPECT_TRUE(report->values.empty());
}

/// Moteus that have the encoder of their rotor alone, whose angle repeats every 4 rad. With the offsets found
/// bring-up puts each joint into its travel, from whatever turn it counts.
TEST(Calibrate, FindsOffsetsThatHoldInEveryTurnOfARotorsEncoder) {
  const std::vector<std::string> moteus = {"hip_driver.protocol=moteus", "knee_driver.protocol=moteus",
                                           "hip_driver.encoder_period_rad=4",
                                           "knee_driver.encoder_period_rad=4"};
  std::vector<std::string> both = kSigns;
  both.insert(both.end(), moteus.begin(), moteus.end());
  HangingRobot robot({.both = both, .robot = kUnknown, .miswired = {}});
  robot.reference_to_rotors();
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  expect_offsets(robot, *report, kUnknown);
  std::vector<std::string> found = both, a_turn_on = both;
  for (const configuration::NewValue& value : report->values) {
    found.push_back(value.section + '.' + value.key + '=' + value.value);
  }
  for (const std::string& setting : kUnknown) a_turn_on.push_back(setting);
  a_turn_on.emplace_back("hip_L.offset_rad=4.4");
  HangingRobot after({.both = found, .robot = a_turn_on, .miswired = {}, .angles_known = true});
  after.reference_to_rotors();
  Session session = after.session();
  const auto up = session.bring_up();
  ASSERT_TRUE(up) << up.error();
  session.tick();
  const double hip_rad = after.robot.plant().state()[model::kFirstJoint];
  EXPECT_NEAR(session.readings().joints[0].position_rad, hip_rad, 0.05);
}

TEST(Calibrate, NoJointGetsTorqueAndDriversAreOffAtTheEnd) {
  HangingRobot robot;
  Helper person(robot);
  ASSERT_TRUE(tried(robot, person));
  constexpr double kHalfAStepOfAFrame_Nm = 0.03;
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_LE(robot.peak_torque_Nm(joint), kHalfAStepOfAFrame_Nm);
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
  }
}

TEST(Calibrate, ChangesNothingOfARobotThatIsRight) {
  HangingRobot robot;
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_TRUE(report->good()) << to_text(*report);
  EXPECT_EQ(report->torso.finding, TorsoFinding::correct) << report->torso.sentence;
  EXPECT_NEAR(report->torso.motion.pitch.gain, 1.0, 0.02);
  EXPECT_NEAR(report->torso.motion.rate.gain, 1.0, 0.02);
  EXPECT_EQ(report->values.size(), 8u) << "sign and offset of each joint, nothing of the sensor";
}

TEST(Calibrate, FindsAStopThatWasNotReached) {
  HangingRobot robot;
  Helper person(robot);
  person.share_of_travel = 0.9;
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_EQ(report->joints[0].finding, CalibrationFinding::wrong_travel) << report->joints[0].sentence;
  EXPECT_NEAR(report->joints[0].travel_share, 0.9, 0.01);
  EXPECT_TRUE(report->values.empty());
  EXPECT_EQ(report->torso.finding, TorsoFinding::not_tried);
}

/// Marks give no travel: a ratio that is a fifth wrong passes, as in a jog, until somebody measures the turn.
TEST(Calibrate, ATurnThatIsMeasuredFromAMarkShowsAWrongRatio) {
  for (const char* turned : {"", "20.6"}) {
    SCOPED_TRACE(turned);
    HangingRobot robot({.both = {}, .robot = {"knee_driver.ratio=1.2"}, .miswired = {}});
    Helper person(robot);
    person.turned = turned;
    const auto report = tried(robot, person, Reference::marks);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_EQ(report->joints[0].finding, CalibrationFinding::correct)
        << "a degree beside the truth: " << report->joints[0].sentence;
    const JointCalibration& knee = report->joints[1];
    EXPECT_EQ(knee.finding == CalibrationFinding::wrong_travel, person.turned == "20.6") << knee.sentence;
    if (person.turned.empty()) continue;
    EXPECT_NE(
        knee.sentence.find("where you measured 0.360 rad; that was read wrong, or its driver's ratio is "
                           "about 1.1"),
        std::string::npos)
        << knee.sentence;
    EXPECT_TRUE(report->values.empty());
  }
}

TEST(Calibrate, ATurnThatIsNoAngleIsRefused) {
  for (const char* turned : {"far", "-20", "181"}) {
    HangingRobot robot;
    Helper person(robot);
    person.turned = turned;
    const auto report = tried(robot, person, Reference::marks);
    ASSERT_FALSE(report) << turned;
    EXPECT_TRUE(report.error().bad_answer) << report.error().sentence;
  }
}

TEST(Calibrate, TakesGravityForTheOffsetOfTheTorsoSensorWhereverTheTorsoHangs) {
  constexpr double kOffset_rad = 0.3;
  HangingRobot robot(
      {.both = {},
       .robot = {"torso_sensor.pitch=id 0x150 byte 0 bits 24 signed little scale -1e-6 offset 0.3",
                 "torso_sensor.pitch_rate=id 0x150 byte 3 bits 16 signed little scale -5e-4"},
       .miswired = {}});
  Helper person(robot);
  person.torso_rest_rad = 0.12;
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  ASSERT_TRUE(report->good()) << to_text(*report);
  EXPECT_TRUE(report->torso.reversed);
  EXPECT_TRUE(report->torso.rate_reversed);
  EXPECT_NEAR(report->torso.offset_rad, kOffset_rad, kAsFarAsAHandHolds_rad);
  const hal::RobotWiring wiring = configuration::robot_wiring(with(robot, *report).hardware);
  EXPECT_NEAR(wiring.channels[0].scale, -1e-6, 1e-12);
  EXPECT_NEAR(wiring.channels[0].offset, kOffset_rad, kAsFarAsAHandHolds_rad);
  EXPECT_NEAR(wiring.channels[1].scale, -5e-4, 1e-9);
}

TEST(Calibrate, FindsTheOffsetOfAnEncoderOfManyTurnsWhereverItCounts) {
  constexpr double kOffset_rad = -2000, kRatio = 2, kTurns = 4096;
  HangingRobot robot(
      {.both = {"torso_sensor.device=canopen_encoder", "torso_sensor.encoder_turns=4096",
                "torso_sensor.encoder_ratio=2", "torso_sensor.encoder_speed_rad_s=0.001"},
       .robot = {"torso_sensor.encoder_offset_rad=-2000", "torso_sensor.encoder_reversed=true"},
       .miswired = {}});
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  ASSERT_TRUE(report->good()) << to_text(*report);
  const configuration::TorsoSensorParameters found = with(robot, *report).hardware.torso_sensor;
  EXPECT_TRUE(found.encoder_reversed);
  const double beside_rad =
      std::remainder(found.encoder_offset_rad - kOffset_rad, 2 * M_PI * kTurns / kRatio);
  EXPECT_NEAR(beside_rad, 0, kAsFarAsAHandHolds_rad) << found.encoder_offset_rad;
}

TEST(Calibrate, ARateOverTheLongestWindowIsNotLate) {
  HangingRobot robot({.both = {"torso_sensor.pitch_rate=none", "torso_sensor.rate_window_s=0.05"},
                      .robot = {},
                      .miswired = {}});
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_TRUE(report->good()) << to_text(*report);
  EXPECT_NEAR(report->torso.motion.rate.delay_s, 0.025, 0.004);
}

TEST(Calibrate, DriversAreOffBeforeTheTorsoIsJudged) {
  HangingRobot robot;
  Helper person(robot);
  Session session = robot.session();
  const CalibrationRequest request = testing::calibration_request(robot, Reference::stops);
  const auto readings = read_poses(session, request, person);
  ASSERT_TRUE(readings) << readings.error().sentence;
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
  }
  EXPECT_TRUE(calibrated(request, *readings).good());  // has no session to keep alive
}

/// A helper that does something of its own at a question.
class OtherHelper final : public Person {
 public:
  using AtQuestion = std::function<void(const std::string&)>;
  OtherHelper(HangingRobot& robot, AtQuestion at_question)
      : helper_(robot), at_question_(std::move(at_question)) {}

  void ask(const std::string& question) override {
    helper_.ask(question);
    at_question_(question);
  }
  std::optional<std::string> answer() override {
    return answers_at_once ? std::optional<std::string>("") : helper_.answer();
  }
  bool gone() const override { return false; }
  bool patient() const override { return answers_at_once; }

  bool answers_at_once = false;

 private:
  Helper helper_;
  AtQuestion at_question_;
};

TEST(Calibrate, APitchThatIsFrozenIsSilentAndNotDead) {
  for (const char* from : {"Release the legs", "Hold the left thigh still with one hand"}) {
    SCOPED_TRACE(from);
    HangingRobot robot;
    OtherHelper person(robot, [&](const std::string& question) {
      if (question.starts_with(from)) robot.lost_id = 0x150;
    });
    const auto report = tried(robot, person);
    ASSERT_TRUE(report) << report.error().sentence;
    EXPECT_EQ(report->torso.finding, TorsoFinding::silent) << report->torso.sentence;
    EXPECT_TRUE(report->values.empty());
  }
}

TEST(Calibrate, ALostZeroIsNamedBeforeThePosesAreJudged) {
  const std::vector<std::vector<std::string>> protocols = {
      {"hip_driver.protocol=mit_ak", "knee_driver.protocol=mit_ak", "hip_driver.accept_missing_watchdog=true",
       "knee_driver.accept_missing_watchdog=true"},
      {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive", "hip_driver.accept_missing_watchdog=true",
       "knee_driver.accept_missing_watchdog=true"}};
  for (const std::vector<std::string>& settings : protocols) {
    SCOPED_TRACE(settings[0]);
    HangingRobot robot({.both = settings, .robot = {}, .miswired = {}});
    const auto power = [&robot](bool on) {
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        robot.robot.drivers().driver(joint).set_powered(on);
        if (on) robot.robot.drivers().driver(joint).power_cycle();
      }
    };
    std::int64_t back_ns = 0;
    robot.each_tick = [&] {
      if (robot.now_ns() == back_ns) power(true);
    };
    OtherHelper person(robot, [&](const std::string& question) {
      if (back_ns != 0 || question.find("(knee_R at ") == std::string::npos) return;
      power(false);
      back_ns = robot.now_ns() + 2'000'000'000;
    });
    const auto report = tried(robot, person);
    ASSERT_FALSE(report) << to_text(*report);
    EXPECT_EQ(report.error().sentence,
              "driver of hip_L was silent or has started again, and counts from power-up: its zero is lost; "
              "begin anew");
  }
}

TEST(Calibrate, AQuestionThatIsRepeatedSaysWhy) {
  HangingRobot robot;
  std::vector<std::string> questions;
  OtherHelper* helper = nullptr;
  OtherHelper person(robot, [&](const std::string& question) {
    questions.push_back(question);
    const bool first = questions.size() == 1;  // the hands are still on their way
    const bool rocks = question.starts_with("Hold the left thigh still");
    helper->answers_at_once = first || rocks;
    if (question.starts_with("the torso did not rock")) robot.stop = true;
  });
  helper = &person;
  ASSERT_FALSE(tried(robot, person));
  EXPECT_TRUE(questions[1].starts_with("a joint moved by ")) << questions[1];
  EXPECT_TRUE(questions[1].ends_with(questions[0])) << questions[1];
  EXPECT_TRUE(questions.back().starts_with("the torso did not rock against the left thigh"))
      << questions.back();
}

TEST(Calibrate, TheNewestMotionOfTheTorsoCounts) {
  HangingRobot robot;
  Helper person(robot);
  person.waits_to_rock_s = 40;
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_EQ(report->torso.finding, TorsoFinding::correct) << report->torso.sentence;
}

TEST(Calibrate, AnAnswerThatIsNoneIsRefused) {
  class Talker final : public Person {
   public:
    void ask(const std::string&) override {}
    std::optional<std::string> answer() override { return "yes"; }
    bool gone() const override { return false; }
    bool patient() const override { return false; }
  } person;
  HangingRobot robot;
  Session session = robot.session();
  const auto report = calibrate(session, testing::calibration_request(robot, Reference::stops), person);
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().bad_answer);
  EXPECT_TRUE(report.error().sentence.starts_with("\"yes\" is no answer to: Hold the leg straight"));
}

TEST(Calibrate, JsonHasEveryJointAndTheTorso) {
  HangingRobot robot({.both = {}, .robot = {"hip_R.offset_rad=0.2"}, .miswired = {}});
  Helper person(robot);
  const auto report = tried(robot, person);
  ASSERT_TRUE(report) << report.error().sentence;
  const auto json = nlohmann::json::parse(to_json(*report, "robot.toml"));
  EXPECT_TRUE(json["good"]);
  EXPECT_EQ(json["joints"]["hip_R"]["finding"], "changed");
  EXPECT_NEAR(json["joints"]["hip_R"]["offset_rad"], 0.2, kAsFarAsAHandHolds_rad);
  EXPECT_EQ(json["torso"]["finding"], "correct");
  EXPECT_EQ(json["written"], "robot.toml");
  EXPECT_TRUE(json["values"].contains("hip_R.offset_rad"));
}

}  // namespace
}  // namespace stilt::commissioning
