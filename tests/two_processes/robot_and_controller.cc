#include "tests/two_processes/robot_and_controller.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "tests/own_domain.h"

namespace stilt::two_processes {
RobotAndController::~RobotAndController() {
  robot_.reset();
  controller_.reset();
}

std::vector<std::string> RobotAndController::words(const std::vector<std::string>& program,
                                                   const std::vector<std::string>& options) const {
  std::vector<std::string> all = program;
  for (const std::size_t number : {0u, 1u}) {
    all.emplace_back("--bus");
    all.push_back(bus(number));
  }
  all.insert(all.end(), options.begin(), options.end());
  return all;
}

std::string RobotAndController::bus(std::size_t number) const {
  const bool is_first = number == 0;
  if (std::getenv("STILT_TEST_VCAN") != nullptr) return is_first ? "vcan0" : "vcan1";
  return "loopback:" + bus_ + (is_first ? ".left" : ".right");
}

void RobotAndController::start_robot(const std::vector<std::string>& options) {
  robot_ = std::make_unique<Process>(
      words({STILT_PROGRAM, "robot", "--json", file("robot.json"), "--frames", file("frames")}, options),
      file("robot.out"), file("robot.err"));
  while (!wait_for_text(file("robot.err"), "ready", 0.05)) {
    if (robot_->wait(0)) throw std::runtime_error("the robot ended at once\n" + said());
  }
}

void RobotAndController::start(std::vector<std::string> program, const std::vector<std::string>& options,
                               const std::string& input) {
  program.insert(program.end(), {"--json", file("controller.json"), "--set",
                                 "telemetry.domain=" + std::to_string(tests::own_domain()), "--set",
                                 "telemetry.token_file=" + file("token")});
  controller_ = std::make_unique<Process>(words(program, options), file("controller.out"),
                                          file("controller.err"), input);
}

void RobotAndController::start_controller(const std::vector<std::string>& options) {
  start({STILTD_PROGRAM}, options);
}

void RobotAndController::start_self_test(const std::vector<std::string>& options) {
  start_command({"selftest"}, options);
}

void RobotAndController::start_command(const std::vector<std::string>& command,
                                       const std::vector<std::string>& options, const std::string& input) {
  std::vector<std::string> program{STILTD_PROGRAM};
  program.insert(program.end(), command.begin(), command.end());
  start(program, options, input);
}

void RobotAndController::start_report(const std::vector<std::string>& options) {
  controller_ = std::make_unique<Process>(words({STILTD_PROGRAM}, options), file("controller.out"),
                                          file("controller.err"));
}

void RobotAndController::end_robot() const {
  robot_->signal(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // two signals are not one key press
  robot_->signal(SIGINT);
}

void RobotAndController::expect_both_to_end() {
  EXPECT_TRUE(controller_->wait(kLongestRun_s)) << "the controller hangs\n" << said();
  EXPECT_TRUE(robot_->wait(kLongestRun_s)) << "the robot hangs\n" << said();
}

nlohmann::json RobotAndController::json(const std::string& name) const {
  return nlohmann::json::parse(std::ifstream(file(name)));
}

std::string RobotAndController::said() const {
  std::string text;
  for (const char* name : {"robot.out", "robot.err", "controller.out", "controller.err"}) {
    text += std::string(name) + ":\n" + text_of(file(name));
  }
  return text;
}

}  // namespace stilt::two_processes
