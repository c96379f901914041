#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "hal/robot/can_robot.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"
#include "tests/host_tools/simulation/robot_on_bus/direct_bus.h"

namespace stilt::robot_on_bus::testing_support {

inline constexpr std::int64_t kTick_ns = 1'000'000;

/// What a test changes of the shipped configuration and of the nominal robot.
struct RobotRequest {
  std::vector<std::string> settings;
  std::vector<std::string> plant;
  std::vector<std::string> faults;
  std::vector<std::string> pushes;
};

[[nodiscard]] configuration::Configuration configuration_of(const RobotRequest& request);
[[nodiscard]] RobotSetup setup_of(const RobotRequest& request);

/// A simulated robot and the hardware abstraction of a controller, in one thread and without sockets.
class DrivenRobot {
 public:
  explicit DrivenRobot(const RobotRequest& request = {});

  /// One tick: commands, when there are any, then the robot, then its reports are read.
  void tick(const hal::JointCommands* commands = nullptr);

  /// Brings up all drivers; each then follows commands. Whether they all are ready.
  bool enable();

  [[nodiscard]] std::vector<hal::CanFrame> received(std::size_t bus) const { return received_[bus]; }

  configuration::Configuration configuration;
  RobotSetup setup;
  RobotOnBus robot;
  std::int64_t now_ns = 1'000'000'000;
  std::array<DirectBus, 2> buses;
  hal::CanRobot can;
  hal::JointReadings readings;
  hal::BaseReading base;

 private:
  [[nodiscard]] hal::JointBringUp bring_up(std::size_t joint) const;

  std::array<std::vector<hal::CanFrame>, 2> received_;
};

}  // namespace stilt::robot_on_bus::testing_support
