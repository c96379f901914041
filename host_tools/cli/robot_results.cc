#include "host_tools/cli/robot_results.h"

#include <cstdio>
#include <string>
#include <utility>

#include "host_tools/cli/summary_text.h"
#include "host_tools/recording/run_clock.h"
#include "host_tools/simulation/plant/plant.h"
#include "host_tools/web/report/report.h"

namespace stilt::cli {
namespace {

using robot_on_bus::RobotOnBus;
using robot_on_bus::RunOutcome;
using Json = nlohmann::ordered_json;

/// The robot's time at which the clock of all results starts. It is when the controller came that was there
/// at the release by the gantry, or, without a release, the last one; 0 without any.
double clock_start_s(const RobotOnBus& robot, const RunOutcome& outcome) {
  const double until_s = robot.gantry_released_s().value_or(robot.time_s());
  double start_s = 0.0;
  for (const double came_s : outcome.controllers_came_s) {
    if (came_s <= until_s) start_s = came_s;
  }
  return start_s;
}

Json drivers_json(const RobotOnBus& robot) {
  Json drivers = Json::array();
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::EmulatedDriver& driver = robot.drivers().driver(joint);
    drivers.push_back({{"joint", simulation::joint_name(joint)},
                       {"powered", driver.powered()},
                       {"enabled", driver.enabled()},
                       {"torque_Nm", robot.drivers().torque_Nm(joint)}});
  }
  return drivers;
}

Json faults_json(const RobotOnBus& robot, double start_s) {
  Json faults = Json::array();
  for (const robot_on_bus::InjectedFault& fault : robot.injected_faults()) {
    faults.push_back(
        {{"name", fault.name}, {"time_s", fault.time_s - start_s}, {"robot_time_s", fault.time_s}});
  }
  return faults;
}

Json robot_json(const RobotOnBus& robot, const log::RunSummary& summary, const RunOutcome& outcome) {
  const double start_s = clock_start_s(robot, outcome);
  const double released_s = robot.gantry_released_s().value_or(0.0) - start_s;
  Json json = plant_json(summary);
  const bool fell = robot.recorder().fall() != simulation::Fall::none;
  json["fall_reason"] = fell ? Json(simulation::fall_text(robot.recorder().fall())) : Json(nullptr);
  json["gantry_released_s"] = robot.gantry_released_s() ? Json(released_s) : Json(nullptr);
  json["sat_down_s"] = robot.sat_down_s() ? Json(released_s + *robot.sat_down_s()) : Json(nullptr);
  json["ended_s"] = robot.time_s() - start_s;
  json["gantry"] = robot_on_bus::name(robot.gantry().state());
  json["robot_time_s"] = robot.time_s();
  json["clock_start_robot_time_s"] = start_s;
  json["ended"] = outcome.ended;
  json["controllers"] = outcome.controllers;
  json["controllers_came_s"] = outcome.controllers_came_s;
  json["drivers"] = drivers_json(robot);
  json["faults"] = faults_json(robot, start_s);
  json["has_priority"] = outcome.has_priority;
  json["late"] = outcome.late;
  json["late_max_s"] = outcome.late_max_s;
  return json;
}

std::string outcome_text(const RobotOnBus& robot, const RunOutcome& outcome) {
  char text[300];
  if (!robot.gantry_released_s()) {
    std::snprintf(text, sizeof text, "result         never left the gantry in %.1f s (%s)\n", robot.time_s(),
                  outcome.ended);
    return text;
  }
  const double start_s = clock_start_s(robot, outcome);
  std::snprintf(text, sizeof text,
                "gantry         released at %.2f s\nend            %s at %.2f s, %llu late\n"
                "clock          the controller's, which came %.2f s after the start of the robot\n",
                *robot.gantry_released_s() - start_s, outcome.ended, robot.time_s() - start_s,
                static_cast<unsigned long long>(outcome.late), start_s);
  return text;
}

void print_results(const RobotOnBus& robot, const log::RunSummary& summary, const RunOutcome& outcome) {
  if (robot.gantry_released_s()) {
    std::fputs(plant_text(summary, robot.recorder().fall()).c_str(), stdout);
  }
  std::fputs(outcome_text(robot, outcome).c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

OutputFiles outputs_of(const RobotOptions& options) {
  return {{"--json", options.json_file},
          {"--report", options.report_file},
          {"--log", options.log_file},
          {"--frames", options.frames_file}};
}

void write_robot_results(const RobotOptions& options, const RobotOnBus& robot, log::RunRecord record,
                         const RunOutcome& outcome, robot_on_bus::FrameLog& frames) {
  if (robot.gantry_released_s()) {
    log::count_from(record, *robot.gantry_released_s() - clock_start_s(robot, outcome));
  }
  if (!on_standard_output(outputs_of(options))) print_results(robot, record.summary, outcome);
  write_each({[&] { frames.close(); },
              [&] {
                if (!options.json_file.empty())
                  write_json(robot_json(robot, record.summary, outcome), options.json_file);
              },
              [&] { write_log(record, options.log_file); },
              [&] {
                if (!options.report_file.empty())
                  write_output_file("--report", options.report_file, report::render_report(record));
              }});
}

}  // namespace stilt::cli
