// From unknown wiring to walking by docs/first-day.md alone: the commands of its table, in their order, to a
// robot whose wiring only `stilt robot` has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/two_processes/person.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {
namespace {

using Words = std::vector<std::string>;

Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The motors of the left leg are exchanged, and a driver has another identifier. The right hip turns the
/// other way, and two joints count from elsewhere. All have friction and damping that the configuration
/// lacks.
const Words kRobot = words_of(
    "--lockstep --set hip_L.id=2 --set hip_L.reply_id=18 --set knee_L.id=1 --set knee_L.reply_id=17 "
    "--set knee_R.id=9 --set hip_R.reversed=false --set hip_L.offset_rad=0.3 --set knee_R.offset_rad=-0.2 "
    "--plant joint_friction_Nm=1 --plant joint_damping=1");

constexpr double kSpeed_m_s = 0.3;  // of the page

/// Words of the commands in the page's table of steps, without `stiltd`.
std::vector<Words> commands_of_page() {
  std::vector<Words> commands;
  std::ifstream page(FIRST_DAY);
  for (std::string line; std::getline(page, line);) {
    const std::string start = "| " + std::to_string(commands.size() + 1) + " | `stiltd ";
    if (!line.starts_with(start)) continue;
    commands.push_back(words_of(line.substr(start.size(), line.find('`', start.size()) - start.size())));
  }
  return commands;
}

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class FirstDay : public testing::Test {
 protected:
  /// Begins the next step of the page, whose robot.toml is the one of this test.
  /// @param command  first word of its command: the step that the test has come to
  /// @param joint  instead of JOINT
  void begin(const std::string& command, const Words& more = {}, const std::string& joint = "") {
    Words words = commands_.at(step_);
    ASSERT_EQ(words.front(), command) << "step " << step_ + 1 << " of the page";
    ASSERT_NE(std::ranges::find(words, "--config"), words.end()) << "step " << step_ + 1 << " of the page";
    for (std::string& word : words) {
      if (word == "JOINT") word = joint;
      if (word == "RAD") word = "0.3";
      if (word == "robot.toml") word = toml_;
    }
    const auto duration = std::ranges::find(words, "--duration");
    if (duration != words.end() && std::ranges::find(more, "--duration") != more.end())
      words.erase(duration, duration + 2);
    if (command == "--check-config") return run_.start_report(words);
    run_.start_command(with(words, more), {"--lockstep"}, keyboard_.name());
  }

  /// The step ends so.
  void expect_status(int status) { EXPECT_EQ(run_.controller().wait(kLongestRun_s), status) << run_.said(); }

  void next_step() { ++step_; }

  [[nodiscard]] std::string printed() const { return text_of(run_.file("controller.out")); }

  /// As with an editor.
  void edit(const std::string& section, const std::string& key, const std::string& value) const {
    std::string text = text_of(toml_);
    const std::size_t line = text.find("\n" + key + " = ", text.find("\n[" + section + "]\n"));
    ASSERT_NE(line, std::string::npos) << section << "." << key;
    const std::size_t at = line + key.size() + 4;
    std::ofstream(toml_) << text.replace(at, text.find('\n', at) - at, value);
  }

  /// Jogs, with a person who saw this, and returns the finding.
  std::string jog(const std::string& joint, const std::string& link, const std::string& way) {
    const std::string answers = run_.file("answers");
    std::ofstream(answers) << link << "\n" << way << "\n\n";
    begin("jog", {"--answers", answers}, joint);
    const auto status = run_.controller().wait(kLongestRun_s);
    const std::string finding = run_.controller_json().at("finding");
    EXPECT_EQ(status, finding == "correct" ? 0 : 1) << run_.said();
    EXPECT_LT(run_.controller_json().at("peak_torque_Nm"), 0.2 * 80.0);
    return finding;
  }

  [[nodiscard]] double newest_rad(const std::string& joint) const {
    std::string text = text_of(run_.file("controller.json"));
    text.resize(text.rfind('\n'));
    const auto sample = nlohmann::json::parse(text.substr(text.rfind('\n') + 1));
    return sample.at("joints").at(joint).at("position_rad");
  }

  /// The joint of the watch that changes when a person moves another by 0.5 rad; "": none, or several.
  std::string joint_that_moves_with(const std::string& moved) {
    std::string found;
    std::map<std::string, double> before_rad;
    for (const char* joint : kJoints) before_rad[joint] = newest_rad(joint);
    if (!person_.does({moved + " 0.5"})) return "";
    for (const char* joint : kJoints) {
      if (std::abs(newest_rad(joint) - before_rad[joint]) > 0.25) found += joint;
    }
    return person_.does({moved + " 0"}) ? found : "";
  }

  void watches();
  void jogs();
  void calibrates();
  void identifies();
  void stands_by_hand();
  void stands_and_walks();

  static constexpr const char* kJoints[] = {"hip_L", "knee_L", "hip_R", "knee_R"};
  RobotAndController run_;
  const Pipe hands_{run_.file("hands")}, keyboard_{run_.file("keyboard")};
  HelpingPerson person_{run_, hands_, keyboard_};
  const std::string toml_ = run_.file("robot.toml");
  const std::vector<Words> commands_ = commands_of_page();
  std::size_t step_ = 0;
};

void FirstDay::watches() {
  begin("watch");
  ASSERT_TRUE(wait_for_text(run_.file("controller.json"), "\n", kLongestRun_s)) << run_.said();
  ASSERT_TRUE(person_.does({"hip_L 0", "knee_L 0", "hip_R 0", "knee_R 0"}));
  EXPECT_EQ(joint_that_moves_with("hip_L"), "knee_L") << "exchanged: jog names it";
  EXPECT_EQ(joint_that_moves_with("knee_L"), "hip_L");
  EXPECT_EQ(joint_that_moves_with("hip_R"), "hip_R");
  EXPECT_EQ(joint_that_moves_with("knee_R"), "knee_R");
  ASSERT_TRUE(person_.does({"let go"}));
  run_.controller().signal(SIGINT);
  expect_status(0);
  next_step();
}

void FirstDay::jogs() {
  ASSERT_EQ(jog("hip_L", "left shin", "backward"), "exchanged_motors");
  edit("hip_L", "id", "2");
  edit("hip_L", "reply_id", "18");
  edit("knee_L", "id", "1");
  edit("knee_L", "reply_id", "17");
  ASSERT_EQ(jog("hip_L", "left thigh", "backward"), "correct");
  ASSERT_EQ(jog("knee_L", "left shin", "backward"), "correct");
  ASSERT_EQ(jog("hip_R", "right thigh", "forward"), "reversed_joint");
  edit("hip_R", "reversed", "false");
  ASSERT_EQ(jog("hip_R", "right thigh", "backward"), "correct");
  ASSERT_EQ(jog("knee_R", "right shin", "backward"), "correct");
  next_step();
}

void FirstDay::calibrates() {
  begin("calibrate");
  person_.calibrates();
  if (HasFatalFailure()) return;
  expect_status(0);
  const nlohmann::json joints = run_.controller_json().at("joints");
  EXPECT_NEAR(joints.at("hip_L").at("offset_rad"), 0.3, 0.01);
  EXPECT_NEAR(joints.at("knee_R").at("offset_rad"), -0.2, 0.01);
  EXPECT_NE(printed().find("the torso sensor is correct"), std::string::npos) << run_.said();
  person_.lets_go();
  next_step();
}

void FirstDay::identifies() {
  begin("identify");
  expect_status(0);
  const nlohmann::json joints = run_.controller_json().at("joints");
  for (const char* joint : kJoints) {
    const nlohmann::json& found = joints.at(joint);
    EXPECT_NEAR(found.at("coulomb_friction_Nm").at("value"), 1.0, 0.3) << joint;
    EXPECT_NEAR(found.at("damping_Nms_rad").at("value"), 1.0, 0.2) << joint;
    EXPECT_NEAR(found.at("torque_factor").at("value"), 1.0, 0.1) << joint;
  }
  next_step();
}

/// Of the robot that still hangs: it waits until hands have put its legs into the pose.
void FirstDay::stands_by_hand() {
  begin("--torque-limit", {"--duration", "600", "--set", "supervisor.stand_wait_s=300"});
  ASSERT_TRUE(wait_for_text(run_.file("controller.err"), "not in a pose to stand up from: ", kLongestRun_s))
      << run_.said();
  ASSERT_TRUE(person_.does({"hip_L -0.58", "knee_L 0.74", "hip_R -0.21", "knee_R 0.74"}));
  ASSERT_TRUE(wait_for_text(run_.file("controller.err"), " s  stand", kLongestRun_s)) << run_.said();
  person_.lets_go();
  run_.controller().signal(SIGINT);
  expect_status(0);
}

void FirstDay::stands_and_walks() {
  run_.start_robot(with(kRobot, {"--once"}));
  begin("--torque-limit", {"--duration", "8"});
  run_.expect_both_to_end();
  expect_status(0);
  EXPECT_EQ(run_.robot_json().at("survived"), true) << run_.said();
  EXPECT_FALSE(run_.robot_json().at("sat_down_s").is_null()) << "in order";
  next_step();

  run_.start_robot(with(kRobot, {"--once"}));
  begin("--torque-limit", {"--duration", "20"});
  run_.expect_both_to_end();
  expect_status(0);
  const nlohmann::json robot = run_.robot_json();
  EXPECT_EQ(robot.at("survived"), true) << run_.said();
  EXPECT_TRUE(run_.controller_json().at("faults").empty()) << run_.controller_json();
  EXPECT_NEAR(robot.at("mean_speed_m_s"), kSpeed_m_s, 0.05);
  EXPECT_GT(robot.at("steps").size(), 30u);
  next_step();
}

/// What this test does in its own way: packages come from the build, buses need no bit rate.
TEST(FirstDayPage, InstallsSetsUpBusesAndDriversWithoutAnotherPage) {
  const std::string page = text_of(FIRST_DAY);
  for (const char* line :
       {"    apt install ./stiltd_*.deb ", "    ip link set can0 up type can bitrate 1000000\n",
        "    ip link set can0 up type can bitrate 1000000 sample-point 0.666 sjw 10 \\\n",
        "      dbitrate 5000000 dsample-point 0.666 dsjw 5 fd on\n", "    ip link set can0 txqueuelen 100\n",
        "`moteus_tool -t 1 --console`: `conf set id.id 2`, then Ctrl-D; `moteus_tool -t 2 --console`: `conf "
        "write`",
        "    conf set servo.timeout_mode 12\n    conf write\n", "    odrive_watchdog_timeout_endpoint = N ",
        "    odrive_enable_watchdog_endpoint = N ", "    odrive_firmware_version = \"N.N.N\" ",
        "    odrive_hardware_version = \"N.N.N\" ",
        "    protocol = \"mit_ak\"                       # or \"mit_mini_cheetah\"\n"
        "    accept_missing_watchdog = true\n"}) {
    EXPECT_NE(page.find(line), std::string::npos) << line;
  }
}

/// The shorter phase of a bit of data at 5 Mbit/s and a sample point of 0.666, in quanta: Linux,
/// drivers/net/can/dev/calc_bittiming.c. From 6.3 on can_sjw_check() refuses a longer jump.
int longest_jump(int clock_Hz) {
  const int quanta = clock_Hz / 5'000'000;
  const int after = quanta - 666 * quanta / 1000;
  const int before = quanta - 1 - after;
  return std::min(before - before / 2, after);
}

TEST(FirstDayPage, TheKernelAllowsTheJumpsOfCanFdAtEachClock) {
  const std::string page = text_of(FIRST_DAY);
  for (const auto& [clock_Hz, text] : {std::pair{80'000'000, "`dsjw 5` is for `clock 80000000`"},
                                       std::pair{40'000'000, "with `clock 40000000` write\n`dsjw 2`"}}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
    EXPECT_NE(std::string(text).find("`dsjw " + std::to_string(longest_jump(clock_Hz)) + '`'),
              std::string::npos)
        << "the longest at " << clock_Hz << " Hz";
  }
}

TEST_F(FirstDay, LeadsFromUnknownWiringToWalking) {
  ASSERT_NE(text_of(FIRST_DAY).find("`stiltd --print-config > robot.toml`"), std::string::npos);
  ASSERT_NE(text_of(FIRST_DAY).find("`stiltd --print-config --robot mine.urdf > robot.toml`"),
            std::string::npos);
  run_.start_report({"--print-config"});
  expect_status(0);
  std::ofstream(toml_) << printed();
  begin("--check-config");
  expect_status(0);
  next_step();

  run_.start_robot(with(kRobot, {"--hang", "--hands", hands_.name()}));
  begin("scan");
  expect_status(1);
  EXPECT_NE(printed().find("knee_R (mit_damiao 4): MISSING"), std::string::npos) << run_.said();
  EXPECT_NE(printed().find("UNEXPECTED: mit_damiao 9"), std::string::npos) << run_.said();
  edit("knee_R", "id", "9");
  begin("scan");
  expect_status(0);
  next_step();

  watches();
  if (!HasFatalFailure()) jogs();
  if (!HasFatalFailure()) calibrates();
  if (!HasFatalFailure()) identifies();
  if (HasFatalFailure()) return;
  begin("selftest");
  expect_status(0);
  next_step();
  stands_by_hand();
  if (HasFatalFailure()) return;
  run_.robot().signal(SIGINT);
  EXPECT_EQ(run_.robot().wait(kLongestRun_s), 0) << run_.said();

  stands_and_walks();
  EXPECT_EQ(step_, commands_.size()) << "steps of the page";
}

}  // namespace
}  // namespace stilt::two_processes
