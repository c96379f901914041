#include "host_tools/cli/sim_command.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <vector>

#include "host_tools/cli/json_output.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/run_description.h"
#include "host_tools/cli/summary_text.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/recording/run/settings.h"
#include "host_tools/simulation/closed_loop/closed_loop.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/simulation/plant/simulated_robot.h"
#include "host_tools/web/report/report.h"

namespace stilt::cli {
namespace {

using simulation::Plant;
using simulation::PlantOptions;
using simulation::RunSettings;
using simulation::TimedCommand;

constexpr double kLargestSpeed_m_s = 5.0;
constexpr double kLongestRun_s = 86400.0;

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// SIGINT and SIGTERM end the run early; its results are still written.
void catch_signals() {
  struct sigaction action{};
  action.sa_handler = [](int) { interrupted.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

PlantOptions plant_options(const SimOptions& options, const control::TimingParameters& timing) {
  PlantOptions plant;
  for (const std::string& assignment : options.plant_settings)
    simulation::set_plant_option(plant, assignment);
  plant.time_step_s = simulation::time_step_for_tick(plant.time_step_s, 1.0 / timing.torque_rate_hz);
  return plant;
}

std::vector<TimedCommand> commands_of(const SimOptions& options) {
  if (!(std::abs(options.speed_m_s) <= kLargestSpeed_m_s)) {
    throw UsageError("--speed " + simulation::number_text(options.speed_m_s) +
                     ": the speed must lie within 5 m/s either way");
  }
  std::vector<TimedCommand> commands = {{0.0, {simulation::parse_gait(options.gait), options.speed_m_s}}};
  for (const std::string& text : options.later_commands)
    commands.push_back(simulation::parse_timed_command(text, options.speed_m_s));
  std::stable_sort(commands.begin(), commands.end(),
                   [](const TimedCommand& a, const TimedCommand& b) { return a.start_s < b.start_s; });
  return commands;
}

std::vector<simulation::TimedFault> faults_of(const SimOptions& options) {
  std::vector<simulation::TimedFault> faults;
  for (const std::string& text : options.faults) {
    faults.push_back(simulation::parse_fault(text));
    if (!simulation::describe(faults.back().kind).needs_bus && !faults.back().bus) continue;
    throw UsageError("--fault " + text +
                     ": this fault needs buses, which stilt sim does not have; use stilt robot");
  }
  return faults;
}

/// Refuses what begins only after the run.
void check_begins(const SimOptions& options, const RunSettings& settings) {
  const auto check = [&](const std::string& option, double start_s) {
    if (start_s < options.duration_s) return;
    throw UsageError(option + " at " + simulation::number_text(start_s) +
                     " s never begins: the run ends at " + simulation::number_text(options.duration_s) +
                     " s; take a longer --duration");
  };
  for (const simulation::Push& push : settings.pushes) check("--push", push.start_s);
  for (const TimedCommand& command : settings.commands) check("--then", command.start_s);
  for (const simulation::TimedFault& fault : settings.faults) check("--fault", fault.start_s);
}

RunSettings run_settings(const SimOptions& options, const model::RobotConstants& robot,
                         const control::TimingParameters& timing) {
  if (!(options.duration_s > 0.0 && options.duration_s <= kLongestRun_s)) {
    throw UsageError("--duration " + simulation::number_text(options.duration_s) +
                     ": the duration must be above 0 and at most 86400 s");
  }
  RunSettings settings;
  settings.duration_s = options.duration_s;
  settings.leg = {robot.thigh_length_m, robot.shin_length_m};
  settings.commands = commands_of(options);
  for (const std::string& text : options.pushes) settings.pushes.push_back(simulation::parse_push(text));
  simulation::check_pushes(settings.pushes, 1.0 / timing.torque_rate_hz);
  settings.use_true_state = simulation::parse_knows_truth(options.state);
  settings.faults = faults_of(options);
  check_begins(options, settings);
  if (options.planner_until_s && !(*options.planner_until_s > 0.0)) {
    throw UsageError("--planner-until " + simulation::number_text(*options.planner_until_s) +
                     ": the time must be above 0 s");
  }
  if (options.planner_until_s) settings.planner_until_s = *options.planner_until_s;
  settings.keep_samples = !options.report_file.empty() || !options.log_file.empty();
  return settings;
}

void write_sim_json(const log::RunSummary& summary, simulation::Fall fall,
                    const control_loop::PlanTiming& timing, const std::string& path) {
  nlohmann::ordered_json json = to_json(summary);
  json["plan_period_s"] = static_cast<double>(timing.period_ticks * timing.tick_ns) / 1e9;
  json["plan_delay_s"] = static_cast<double>(timing.delay_ticks * timing.tick_ns) / 1e9;
  json["fall_reason"] = summary.survived ? nlohmann::ordered_json(nullptr)
                                         : nlohmann::ordered_json(simulation::fall_text(fall));
  write_json(json, path);
}

OutputFiles outputs_of(const SimOptions& options) {
  return {{"--json", options.json_file}, {"--report", options.report_file}, {"--log", options.log_file}};
}

void write_results(const SimOptions& options, const log::RunRecord& record, simulation::Fall fall,
                   const control_loop::PlanTiming& timing) {
  if (!on_standard_output(outputs_of(options))) {
    std::fputs(summary_text(record.summary, fall, timing).c_str(), stdout);
  }
  write_each({[&] {
                if (!options.json_file.empty())
                  write_sim_json(record.summary, fall, timing, options.json_file);
              },
              [&] { write_log(record, options.log_file); },
              [&] {
                if (!options.report_file.empty())
                  write_output_file("--report", options.report_file, report::render_report(record));
              }});
}

}  // namespace

CLI::App* add_sim_command(CLI::App& program, SimOptions& options) {
  CLI::App* sim = program.add_subcommand("sim", "walk the simulated robot under the controller");
  add_controller_options(*sim, options.choice);
  const control::TimingParameters shipped = configuration::Configuration{}.timing;
  sim->add_option("--plan-rate", options.choice.plan_rate_hz,
                  "plans per second, Hz, rounded to whole ticks between two and at most 1 / --plan-delay; "
                  "default: timing.plan_rate_hz")
      ->default_str(simulation::number_text(shipped.plan_rate_hz));
  sim->add_option("--plan-delay", options.choice.plan_delay_s,
                  "simulated time that a plan takes, s, rounded to whole ticks, at least one; "
                  "default: timing.plan_delay_s")
      ->default_str(simulation::number_text(shipped.plan_delay_s));
  add_gains_option(*sim, options.choice);
  sim->add_option("--gait", options.gait, "stand, step or walk, commanded at the start")
      ->capture_default_str();
  sim->add_option("--speed", options.speed_m_s, "walking speed, m/s, negative backward")
      ->capture_default_str();
  sim->add_option("--then", options.later_commands,
                  "a later command, GAIT[:SPEED]@START, without SPEED at that of --speed; repeatable")
      ->allow_extra_args(false);
  sim->add_option("--duration", options.duration_s, "simulated time, s")->capture_default_str();
  sim->add_option("--push", options.pushes,
                  "a push, N@START+DURATION[@hip|torso], positive forward, from tick to tick; "
                  "repeatable")
      ->allow_extra_args(false);
  sim->add_option(
         "--state", options.state,
         "state that the controller gets: estimated (from sensors) or truth (all but the base's velocity)")
      ->capture_default_str();
  sim->add_option("--planner-until", options.planner_until_s, "the planner stops at this time, s");
  sim->add_option(
         "--fault", options.faults,
         "a fault of the robot, NAME[:JOINT]@START[+DURATION], times in s from the start; repeatable")
      ->allow_extra_args(false);
  sim->add_option("--seed", options.seed, "seed of the sensor noise")
      ->check(CLI::Range(std::uint32_t{0}, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  sim->add_option("--plant", options.plant_settings,
                  "changes the simulated robot or its world: KEY=VALUE; repeatable")
      ->allow_extra_args(false);
  sim->add_option("--json", options.json_file,
                  "writes the results as JSON to a file, or - for standard output");
  sim->add_option("--report", options.report_file, "writes a page with animation and plots, HTML");
  sim->add_option("--log", options.log_file,
                  "writes the samples, one JSON object per line, to a file, or - for standard output");
  sim->footer("Keys of --plant:\n" + simulation::describe_plant_options() + "Faults:\n" +
              simulation::describe_faults(simulation::FaultsOf::plant) +
              "Ctrl-C ends the run early; its results are written.\n"
              "Exit status: 0 done, 1 the robot fell, 2 bad usage.");
  return sim;
}

int run_sim(const SimOptions& options, const std::string& command_line) {
  check_output_files(outputs_of(options), files_read(options.choice));
  const model::RobotModel& robot = robot_model(options.choice.robot);
  const configuration::Configuration parameters = controller_configuration(options.choice);
  const PlantOptions world = plant_options(options, parameters.timing);
  RunSettings settings = run_settings(options, robot.constants, parameters.timing);
  const auto controller = make_controller(controller_setup(options.choice, robot, parameters));
  Plant plant(simulation::make_plant_model(find_robot(options.choice.robot).tree, world,
                                           parameters.reference.base_height_m),
              world, options.seed);
  settings.initial_state = standing_on_ground(world, settings.leg, parameters);
  log::RunRecord record;
  {
    Progress progress("simulating", options.duration_s, "s");
    settings.progress = [&](double time_s) { progress.update(time_s); };
    settings.stop = &interrupted;
    catch_signals();
    record = simulation::run_closed_loop(plant, *controller, settings);
  }
  if (interrupted.load()) {
    std::fprintf(stderr, "interrupted: the results are of the first %.2f s\n", record.summary.duration_s);
  }
  record.command_line = command_line;
  record.settings = record::settings_of(parameters);
  record.settings.insert(record.settings.begin(), {"robot", robot.constants.name});
  record.allowed_torque_Nm = record::allowed_torque_Nm(parameters, robot.constants);
  describe_run(robot.constants, plant, world, record);
  write_results(options, record, plant.fall(), controller->timing());
  return record.summary.survived ? 0 : 1;
}

}  // namespace stilt::cli
