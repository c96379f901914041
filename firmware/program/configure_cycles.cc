#include "firmware/program/configure_cycles.h"

namespace stilt::program {
namespace {

std::expected<void, std::string> configure_planner(const model::RobotModel& robot,
                                                   const configuration::Configuration& configuration,
                                                   const std::string& source,
                                                   controller::PlannerCycle& planner) {
  switch (planner.configure(robot, configuration)) {
    case control::ConfigureStatus::ok:
      return {};
    case control::ConfigureStatus::horizon_over_capacity:
      return std::unexpected(source +
                             ": discretisation.horizon_s needs more intervals or contact switches than the "
                             "planner holds; take a shorter horizon or a longer time step");
    case control::ConfigureStatus::terminal_cost_failed:
      break;
  }
  return std::unexpected(
      source +
      ": the weights in cost admit no terminal cost; give every position and velocity some "
      "weight, or set cost.terminal to 0");
}

}  // namespace

std::expected<void, std::string> configure_cycles(const configuration::Configuration& configuration,
                                                  const std::string& source,
                                                  controller::PlannerCycle& planner,
                                                  controller::TorqueCycle& torque) {
  const model::RobotModel* robot = model::find_robot(configuration.hardware.robot.c_str());
  if (robot == nullptr) {
    return std::unexpected(source + ": hardware.robot \"" + configuration.hardware.robot +
                           "\" has no model in this program");
  }
  if (const auto ready = configure_planner(*robot, configuration, source, planner); !ready) return ready;
  torque.configure(*robot, configuration, configuration.supervisor);
  return {};
}

}  // namespace stilt::program
