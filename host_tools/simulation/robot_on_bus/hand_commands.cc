#include "host_tools/simulation/robot_on_bus/hand_commands.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <sstream>

namespace stilt::robot_on_bus {
namespace {

constexpr double kRocking_rad = 0.2;
constexpr double kRocking_hz = 0.6;
constexpr double kRocking_s = 5.0;
constexpr double kSettles_s = 1.0;  // what a hand holds, and longer than half a swing of a leg
constexpr double kStill_rad_s = 0.01;
constexpr double kLargest_rad = 3.2;

/// Index in q of what a line names; 0: none.
int angle_of(const std::string& name) {
  if (name == "torso") return model::kFirstAngle;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (name == simulation::joint_name(joint)) return model::kFirstJoint + static_cast<int>(joint);
  }
  return 0;
}

bool legs_still(const RobotOnBus& robot) {
  return robot.plant().state().tail<model::kJoints>().cwiseAbs().maxCoeff() < kStill_rad_s;
}

/// Without blanks around it and between its words but one.
std::string words_of(const std::string& line, std::string& first, std::string& second) {
  std::istringstream stream(line);
  std::string words;
  for (std::string word; stream >> word; words += (words.empty() ? "" : " ") + word) {
    if (words.empty()) {
      first = word;
    } else {
      second += (second.empty() ? "" : " ") + word;
    }
  }
  return words;
}

}  // namespace

bool HandCommands::move(const std::string& name, const std::string& angle, RobotOnBus& robot) {
  double to_rad = 0;
  const auto read = std::from_chars(angle.data(), angle.data() + angle.size(), to_rad);
  const int index = angle_of(name);
  const bool is_number = read.ec == std::errc{} && read.ptr == angle.data() + angle.size();
  if (index == 0 || !is_number || !(std::abs(to_rad) <= kLargest_rad)) return false;
  robot.hands().move(index, to_rad);
  lasts_s_ = std::abs(to_rad - robot.plant().state()[index]) / Hands::kHandSpeed_rad_s + kSettles_s;
  return true;
}

/// Takes the next line, if there is one.
HandReport HandCommands::begin(RobotOnBus& robot) {
  const std::size_t end = typed_.find('\n');
  if (end == std::string::npos) return {};
  std::string first, second;
  const std::string line = words_of(typed_.substr(0, end), first, second);
  typed_.erase(0, end + 1);
  if (line.empty()) return {};
  ++lines_;
  if (rocks_) robot.hands().let_go();
  rocks_ = line == "rock";
  began_s_ = robot.time_s();
  if (rocks_) {
    robot.hands().hold_left_thigh();
    lasts_s_ = kRocking_s;
  } else if (line == "let go") {
    robot.hands().let_go();
    lasts_s_ = kSettles_s;
  } else if (!move(first, second, robot)) {
    return {"line " + std::to_string(lines_) + ", \"" + line + "\", is none of " + kLines +
                ", with at most 3.2 rad",
            true};
  }
  line_ = line;
  return {};
}

void HandCommands::rock(RobotOnBus& robot) const {
  const double time_s = robot.time_s() - began_s_;
  robot.hands().move(model::kFirstAngle,
                     kRocking_rad * std::sin(2 * std::numbers::pi * kRocking_hz * time_s));
}

HandReport HandCommands::serve(RobotOnBus& robot) {
  if (rocks_) rock(robot);
  if (line_.empty()) return begin(robot);
  if (line_ == "let go" && !legs_still(robot)) began_s_ = robot.time_s();
  if (robot.time_s() - began_s_ < lasts_s_) return {};
  HandReport report{std::to_string(lines_) + ": " + line_ + ": done"};
  line_.clear();
  return report;
}

}  // namespace stilt::robot_on_bus
