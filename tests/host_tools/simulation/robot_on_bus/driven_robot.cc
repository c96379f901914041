#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "host_tools/cli/robot_setup.h"

namespace stilt::robot_on_bus::testing_support {

configuration::Configuration configuration_of(const RobotRequest& request) {
  std::vector<configuration::Override> overrides;
  overrides.reserve(request.settings.size());
  for (const std::string& setting : request.settings) overrides.push_back({setting});
  const configuration::Result result = configuration::load_robot("amber3m", overrides);
  if (!result) throw std::runtime_error(configuration::to_string(result.error().front()));
  return *result;
}

RobotSetup setup_of(const RobotRequest& request) {
  cli::RobotOptions options;
  options.settings = request.settings;
  options.plant_settings = request.plant;
  options.faults = request.faults;
  options.pushes = request.pushes;
  return cli::simulated_hardware(options).setup;
}

DrivenRobot::DrivenRobot(const RobotRequest& request)
    : configuration(configuration_of(request)),
      setup(setup_of(request)),
      robot(setup),
      buses{DirectBus(robot, 0, now_ns), DirectBus(robot, 1, now_ns)},
      can(setup.wiring, std::array<hal::FrameBus*, 2>{&buses[0], &buses[1]}) {}

void DrivenRobot::tick(const hal::JointCommands* commands) {
  if (commands != nullptr) static_cast<void>(can.write(*commands));
  now_ns += kTick_ns;
  robot.tick(now_ns);
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    received_[bus] = robot.take_outgoing(now_ns, bus);
    buses[bus].waiting.insert(buses[bus].waiting.end(), received_[bus].begin(), received_[bus].end());
  }
  static_cast<void>(can.read(now_ns, readings));
  static_cast<void>(can.read_base(base));
  can.serve_torso_sensor(now_ns);
}

hal::JointBringUp DrivenRobot::bring_up(std::size_t joint) const {
  const auto options = configuration::bring_up_options(configuration.hardware, joint, -2.8, 2.8);
  return hal::visit_driver(setup.wiring.joints[joint].driver, [&](const auto& driver) -> hal::JointBringUp {
    return make_bring_up(driver, options);
  });
}

bool DrivenRobot::enable() {
  constexpr int kMostTicks = 500;
  std::array<hal::JointBringUp, hal::kJoints> ups{bring_up(0), bring_up(1), bring_up(2), bring_up(3)};
  const auto base_of = [](hal::JointBringUp& up) -> hal::bring_up::BringUp& {
    return std::visit([](auto& any) -> hal::bring_up::BringUp& { return any; }, up);
  };
  for (int i = 0; i < kMostTicks; ++i) {
    bool ready = true;
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const std::size_t bus = setup.wiring.joints[joint].bus;
      const hal::bring_up::StepResult result = base_of(ups[joint]).step(now_ns, received_[bus]);
      if (result.send) static_cast<void>(buses[bus].send(std::span(&result.frame, 1)));
      ready = ready && result.stage == hal::bring_up::Stage::ready;
    }
    tick();
    if (ready) return true;
  }
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const std::size_t bus = setup.wiring.joints[joint].bus;
    const hal::bring_up::StepResult result = base_of(ups[joint]).step(now_ns, received_[bus]);
    ADD_FAILURE() << "joint " << joint << " is at " << name(result.stage) << ": " << name(result.failure)
                  << ", " << name(result.setting);
  }
  return false;
}

}  // namespace stilt::robot_on_bus::testing_support
