#include "firmware/program/configure_controller.h"

#include "firmware/configuration/gaits/load_around_gaits.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/program/instruction_sets.h"
#include "firmware/robots/robots.h"

namespace stilt::program {
namespace {

std::expected<void, std::string> configure_planner(const model::RobotModel& robot,
                                                   const configuration::Configuration& configuration,
                                                   const std::string& source,
                                                   control_loop::PlannerTask& planner) {
  switch (planner.configure(robot, configuration)) {
    case control::ConfigureStatus::ok:
      return {};
    case control::ConfigureStatus::horizon_over_capacity:
      return std::unexpected(source +
                             ": discretisation.horizon_s needs more intervals or contact switches than the "
                             "planner holds; take a shorter horizon or a longer time step");
    case control::ConfigureStatus::no_such_instructions:
      return std::unexpected(source + ": " + no_such_instructions(configuration));
    case control::ConfigureStatus::terminal_cost_failed:
      break;
  }
  return std::unexpected(
      source +
      ": the weights in cost admit no terminal cost; give every position and velocity some "
      "weight, or set cost.terminal to 0");
}

/// Gaits for the reference of the plans, and for the level below them. A robot without gaits has no such
/// level.
std::expected<void, std::string> follow_gaits(const model::RobotModel& robot,
                                              const configuration::Configuration& configuration,
                                              const std::string& source, control_loop::PlannerTask& planner,
                                              control_loop::ControlLoop& loop, gait::GaitLibrary& gaits) {
  const bool planned = configuration.controller.reference == configuration::ReferenceKind::hzd;
  const auto loaded = gait_files::load_shipped_library(configuration.hardware.robot, gaits);
  if (!loaded && planned)
    return std::unexpected(source + ": controller.reference is hzd, and " + loaded.error() +
                           std::string(gait_files::kOnlyShippedGaits));
  if (!loaded && configuration.supervisor.select_gait)
    return std::unexpected(source + ": supervisor.select_gait is true, and " + loaded.error() +
                           "; set it to false");
  if (!loaded) return {};
  if (planned) planner.follow(gaits);
  if (configuration.supervisor.track_gait) loop.track_without_plan(robot, configuration, gaits);
  return {};
}

}  // namespace

std::expected<void, std::string> configure_controller(const configuration::Configuration& configuration,
                                                      const std::string& source,
                                                      control_loop::PlannerTask& planner,
                                                      control_loop::ControlLoop& loop,
                                                      gait::GaitLibrary* gaits) {
  const auto found = robots::find(configuration.hardware.robot);
  if (!found) return std::unexpected(source + ": hardware.robot: " + found.error());
  const model::RobotModel& robot = (*found)->model;
  if (const auto ready = configure_planner(robot, configuration, source, planner); !ready) return ready;
  loop.configure(robot, configuration, configuration.supervisor);
  if (gaits == nullptr) return {};
  return follow_gaits(robot, configuration, source, planner, loop, *gaits);
}

}  // namespace stilt::program
