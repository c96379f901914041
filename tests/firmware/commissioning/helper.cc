#include "tests/firmware/commissioning/helper.h"

#include <cmath>
#include <stdexcept>

#include "firmware/control_loop/joint_names.h"
#include "firmware/robots/robots.h"

namespace stilt::commissioning::testing {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kRocking_ns = 5 * kSecond_ns;
constexpr double kRocking_rad = 0.2;
constexpr double kRocking_hz = 0.6;

}  // namespace

void Helper::ask(const std::string& question) {
  measures_ = question.find("turn from its mark") != std::string::npos;
  if (measures_) return;
  looks_ = question.starts_with("Which") || question.starts_with("By how many");
  asked_ns_ = robot_.now_ns();
  rocks_ = question.find("rock the torso") != std::string::npos;
  robot_on_bus::Hands& hands = robot_.robot.hands();
  if (looks_) return onlooker_.ask(question);
  hands.let_go();
  if (rocks_) {
    hands.hold_left_thigh();
    begins_ns_ = asked_ns_ + static_cast<std::int64_t>(waits_to_rock_s * kSecond_ns);
    done_ns_ = begins_ns_ + kRocking_ns;
  } else if (question.starts_with("Release the legs")) {
    hands.move(model::kFirstAngle, torso_rest_rad);
    done_ns_ = asked_ns_ + 8 * kSecond_ns;
  } else {
    move_joint(question);
    done_ns_ = asked_ns_ + 5 * kSecond_ns;
  }
}

/// Holds the leg's other joint at 0, and moves the one whose name and angle the question has.
void Helper::move_joint(const std::string& question) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const std::string mark = std::string("(") + control_loop::kJointNames[joint] + " at ";
    const std::size_t at = question.find(mark);
    if (at == std::string::npos) continue;
    const double asked_rad = std::stod(question.substr(at + mark.size()));
    const double angle_rad = exchanges_ways && joint % 2 == 0 ? -asked_rad : asked_rad;
    robot_on_bus::Hands& hands = robot_.robot.hands();
    hands.move(model::kFirstJoint + static_cast<int>(joint ^ 1U), 0);
    hands.move(model::kFirstJoint + static_cast<int>(joint), share_of_travel * angle_rad);
    return;
  }
  throw std::runtime_error("no joint in: " + question);
}

void Helper::rock() {
  if (robot_.now_ns() < begins_ns_) return;
  const double time_s = 1e-9 * static_cast<double>(robot_.now_ns() - begins_ns_);
  const double angle_rad = kRocking_rad * std::sin(2 * M_PI * kRocking_hz * time_s);
  robot_.robot.hands().move(model::kFirstAngle, angle_rad);
}

std::optional<std::string> Helper::answer() {
  if (measures_) return turned;
  if (looks_) return onlooker_.answer();
  if (rocks_) rock();
  if (robot_.now_ns() < done_ns_) return std::nullopt;
  if (rocks_) robot_.robot.hands().let_go();
  return "";
}

CalibrationRequest calibration_request(const HangingRobot& robot, Reference reference) {
  const auto found = robots::find("amber3m");
  if (!found) throw std::runtime_error(found.error());
  const model::RobotConstants& constants = (*found)->model.constants;
  return {.reference = reference,
          .hardware = robot.configuration.hardware,
          .minimum_rad = std::to_array(constants.position_min_rad),
          .maximum_rad = std::to_array(constants.position_max_rad)};
}

}  // namespace stilt::commissioning::testing
