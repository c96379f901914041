#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>

#include "firmware/commissioning/scan.h"
#include "firmware/commissioning/watch.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/control_loop/joint_names.h"
#include "tests/firmware/commissioning/helper.h"

/// The first day with each robot of miswired_robots.toml: what is found first, and by which command. Knees of
/// the robots that have end stops hang at them.
namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using testing::Helper;
using testing::Wiring;

const std::vector<std::vector<std::string>> kPlants = {{}, {"joint_stops=1"}};

struct MiswiredRobot {
  std::string name;
  Wiring wiring;
  std::string found_by;
  std::string says;
};

std::vector<std::string> words(const toml::table& row, const char* key) {
  std::vector<std::string> all;
  if (const toml::array* array = row[key].as_array()) {
    for (const toml::node& word : *array) all.push_back(word.value<std::string>().value());
  }
  return all;
}

std::vector<MiswiredRobot> miswired_robots() {
  const toml::table root = toml::parse_file(MISWIRED_ROBOTS);
  std::vector<MiswiredRobot> robots;
  for (const toml::node& node : *root["robot"].as_array()) {
    const toml::table& row = *node.as_table();
    robots.push_back({.name = row["name"].value<std::string>().value(),
                      .wiring = {words(row, "both"), words(row, "robot"), words(row, "miswired")},
                      .found_by = row["found_by"].value<std::string>().value(),
                      .says = row["says"].value<std::string>().value()});
  }
  return robots;
}

/// What a command reported, if there was a fault.
struct Complaint {
  std::string command;
  std::string sentence;
};
using Complaints = std::optional<Complaint>;

Complaints scanned(HangingRobot& robot) {
  const ScanResult result =
      scan(robot.configuration.hardware, robot.wanted(), robot.frame_buses(), robot, robot.stop);
  if (result.complete()) return std::nullopt;
  return Complaint{"scan", to_text(result)};
}

Complaints watched(HangingRobot& robot) {
  Session session = robot.session();
  const auto done = watch(session, 0.2, [](const WatchSample&) {});
  if (done) return std::nullopt;
  return Complaint{"watch", done.error()};
}

Complaints jogged(HangingRobot& robot, Helper& person, std::size_t joint) {
  const std::string command = std::string("jog ") + control_loop::kJointNames[joint];
  robot.forget_sightings();
  Session session = robot.session();
  const auto& hardware = robot.configuration.hardware;
  const auto report =
      jog_and_ask(session, robot.jog_request(joint, 0.3), configuration::driver_of(hardware, joint), person);
  if (!report) return Complaint{command, report.error().sentence};
  if (report->verdict.finding == Finding::correct) return std::nullopt;
  return Complaint{command, report->verdict.sentence};
}

/// A calibration that changes something has found it, too.
Complaints calibrated(HangingRobot& robot, Helper& person) {
  Session session = robot.session();
  const auto report = calibrate(session, testing::calibration_request(robot, Reference::stops), person);
  if (!report) return Complaint{"calibrate", report.error().sentence};
  const bool right = report->torso.finding == TorsoFinding::correct &&
                     std::ranges::all_of(report->joints, [](const JointCalibration& joint) {
                       return joint.finding == CalibrationFinding::correct;
                     });
  if (right) return std::nullopt;
  return Complaint{"calibrate", to_text(*report)};
}

/// A command after the other, as docs/first-day.md has them, until one finds something.
Complaints first_day(HangingRobot& robot) {
  Helper person(robot);
  if (const Complaints found = scanned(robot)) return found;
  if (const Complaints found = watched(robot)) return found;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (const Complaints found = jogged(robot, person, joint)) return found;
  }
  return calibrated(robot, person);
}

void expect_little_torque(const HangingRobot& robot) {
  constexpr double kAStepOfAFrame_Nm = 0.06;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_LE(robot.peak_torque_Nm(joint), 0.2 * 80.0 + kAStepOfAFrame_Nm);
  }
}

TEST(FirstDay, FindsAndNamesEachMistakeWithAFifthOfTheTorque) {
  const std::vector<MiswiredRobot> robots = miswired_robots();
  EXPECT_GE(robots.size(), 20u);
  for (const MiswiredRobot& miswired : robots) {
    for (const std::vector<std::string>& plant : kPlants) {
      SCOPED_TRACE(miswired.name + (plant.empty() ? "" : ", with end stops"));
      Wiring wiring = miswired.wiring;
      wiring.plant = plant;
      HangingRobot robot(wiring);
      const Complaints found = first_day(robot);
      ASSERT_TRUE(found);
      EXPECT_EQ(found->command, miswired.found_by) << found->sentence;
      EXPECT_NE(found->sentence.find(miswired.says), std::string::npos) << found->sentence;
      expect_little_torque(robot);
    }
  }
}

TEST(FirstDay, FindsNothingWhereNothingIsWrong) {
  for (const std::vector<std::string>& plant : kPlants) {
    HangingRobot robot({.both = {}, .robot = {}, .miswired = {}, .plant = plant});
    const Complaints found = first_day(robot);
    EXPECT_FALSE(found) << found->command << ": " << found->sentence;
    expect_little_torque(robot);
  }
}

}  // namespace
}  // namespace stilt::commissioning
