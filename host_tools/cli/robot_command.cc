#include "host_tools/cli/robot_command.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <limits>

#include "firmware/configuration/configuration.h"
#include "host_tools/cli/controller_choice.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/network_options.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/robot_results.h"
#include "host_tools/cli/robot_setup.h"
#include "host_tools/cli/run_description.h"
#include "host_tools/cli/typed_hands.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/robot_on_bus/runner.h"
#include "host_tools/simulation/robot_on_bus/serial_line.h"
#include "host_tools/telemetry/simulation_publisher.h"

namespace stilt::cli {
namespace {

using robot_on_bus::RobotOnBus;
using robot_on_bus::RunOutcome;

constexpr const char* kHanging = "the robot hangs on its gantry; on its own";
constexpr const char* kReleased = "the robot is on its own";
constexpr const char* kEnding =
    "the robot goes on until its controller has ended, 30 s at most; a second Ctrl-C ends it now";
constexpr double kEndless_s = std::numeric_limits<double>::infinity();

std::atomic<bool> end_asked = false, interrupted = false;
std::atomic<std::int64_t> first_signal_ns = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);

/// The first signal asks for the end, a second one makes it. One key press may arrive twice, from the
/// terminal and from a wrapper: not that.
void interrupt(int) {
  constexpr std::int64_t kOnePress_ns = 300'000'000;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);  // may be called in a handler
  const std::int64_t now_ns = std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
  std::int64_t first_ns = 0;
  if (!first_signal_ns.compare_exchange_strong(first_ns, now_ns) && now_ns - first_ns > kOnePress_ns) {
    interrupted.store(true);
  }
  end_asked.store(true);
}

/// Announces that the controller can start.
void announce(const std::vector<std::string>& buses) {
  std::string names;
  for (const std::string& bus : buses) names += (names.empty() ? "" : ", ") + bus;
  std::fprintf(stderr, "the robot hangs on its gantry, ready for a controller on %s\n", names.c_str());
}

/// SIGINT and SIGTERM end the run in order, a controller first; its figures are still written.
void catch_signals() {
  struct sigaction action{};
  action.sa_handler = interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// @param robot  as --robot or the configuration names it
void check_files(const RobotOptions& options, const std::string& robot) {
  std::vector<std::string> inputs = files_read(CommandInputs{robot, options.config_file, "", ""});
  inputs.push_back(options.hands_file);
  check_output_files(outputs_of(options), inputs);
}

/// Contact forces and the active push, for the monitor's picture.
host_telemetry::SimulationMessage truth_of(const RobotOnBus& robot,
                                           const std::vector<simulation::Push>& pushes) {
  host_telemetry::SimulationMessage message{};
  message.robot_time_s = robot.time_s();
  const model::FeetVector forces = robot.plant().contact_force_N();
  for (int k = 0; k < 2 * model::kFeet; ++k) message.contact_force_N[k] = forces[k];
  const simulation::ActingPush push = simulation::push_at(pushes, robot.walk_time_s().value_or(-1.0));
  message.push_N = push.force_N;
  message.push_above_hip_m = simulation::push_above_hip_m(push.point);
  return message;
}

}  // namespace

CLI::App* add_robot_command(CLI::App& program, RobotOptions& options) {
  CLI::App* robot = program.add_subcommand("robot", "the simulated robot behind its motor drivers");
  robot->add_option("--robot", options.robot, robot_help() + "; default: that of --config")
      ->default_str(std::string(configuration::kDefaultRobot));
  robot->add_option("--config", options.config_file,
                    "configuration (TOML) that names drivers and wiring, instead of the shipped one");
  add_preset_option(*robot, options.preset);
  robot->add_option("--set", options.settings, "changes one key of it: section.key=value; repeatable")
      ->allow_extra_args(false);
  robot
      ->add_option("--bus", options.buses,
                   "a bus, can0, vcan0 or loopback:NAME, instead of the configuration's; repeatable")
      ->allow_extra_args(false);
  robot->add_flag("--lockstep", options.lockstep,
                  "time follows the controller's turns instead of the clock: for tests");
  robot->add_option("--duration", options.duration_s,
                    "ends so long after the gantry has released the robot, s");
  robot->add_flag("--once", options.once, "ends when the controller has disconnected");
  robot
      ->add_option(
          "--fault", options.faults,
          "a fault, NAME[:JOINT|BUS]@START[+DURATION], s after the gantry has released the robot; repeatable")
      ->allow_extra_args(false);
  robot
      ->add_option("--push", options.pushes,
                   "a push, N@START+DURATION[@hip|torso], positive forward, from tick to tick; "
                   "repeatable")
      ->allow_extra_args(false);
  robot
      ->add_option("--plant", options.plant_settings,
                   "changes the simulated robot or its world: KEY=VALUE; repeatable")
      ->allow_extra_args(false);
  robot->add_flag("--hang", options.hang,
                  "hangs for good, its legs free: for stiltd scan, watch and jog; not with --fault");
  robot->add_option(
      "--hands", options.hands_file,
      "with --hang: hands on it, for stiltd watch, calibrate and zero: lines of a FIFO, a file or -: " +
          std::string(TypedHands::kLines));
  robot
      ->add_option("--miswired", options.miswired,
                   "a mistake of the wiring, NAME:JOINT; repeatable. Others are keys of --set, such as "
                   "exchanged identifiers")
      ->allow_extra_args(false);
  robot->add_option("--seed", options.seed, "of the sensor noise")
      ->check(CLI::Range(std::uint32_t{0}, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  robot->add_flag(
      "--publish", options.publish,
      "publishes over DDS what only a simulation has (contact forces, pushes), for stilt monitor");
  add_network_options(*robot, options.network);
  robot->add_option("--json", options.json_file,
                    "writes the results as JSON to a file, or - for standard output");
  robot->add_option("--report", options.report_file, "writes a page with animation and plots, HTML");
  robot->add_option("--log", options.log_file, "writes the samples, one JSON object per line");
  robot->add_option("--frames", options.frames_file, "writes every frame on the buses with its tick");
  robot->footer(
      "Faults of --fault:\n" + simulation::describe_faults(simulation::FaultsOf::robot_on_buses) +
      "Keys of --plant:\n" + simulation::describe_plant_options() + "Mistakes of --miswired:\n" +
      describe_mistakes() +
      "Times of --push and --fault count from when the gantry has released the robot. Times of the results,\n"
      "report and log are on the clock of the controller that stood it up, as those that stiltd prints.\n"
      "At Ctrl-C or SIGTERM it goes on until its controller has ended, 30 s at most: one Ctrl-C for both\n"
      "sits it down. A second one, 0.3 s later or more, ends it at once.\n"
      "Exit status: 0 done, 1 the robot fell or never left the gantry, 2 bad usage.");
  return robot;
}

int run_robot(const RobotOptions& options, const std::string& command_line) {
  check_files(options, options.robot);
  if (!options.hands_file.empty() && !options.hang) {
    throw UsageError("--hands: the robot must hang for good; add --hang");
  }
  TypedHands hands(options.hands_file);
  const SimulatedHardware hardware = simulated_hardware(options);
  check_files(options, hardware.robot->constants.name);
  RobotOnBus robot(hardware.setup);
  std::vector<robot_on_bus::RobotBus> buses;
  for (const std::string& name : hardware.bus_names) buses.emplace_back(name, hardware.fd);
  std::optional<robot_on_bus::SerialLine> serial;
  if (!hardware.serial_port.empty()) serial.emplace(hardware.serial_port);
  robot_on_bus::FrameLog frames(options.frames_file);
  catch_signals();
  announce(hardware.bus_names);
  RunOutcome outcome;
  {
    Progress progress(kHanging, options.duration_s.value_or(kEndless_s), "s");
    robot_on_bus::RunOptions run;
    run.tick_s = hardware.setup.tick_s;
    run.duration_s = options.duration_s;
    run.once = options.once;
    run.stop = &interrupted;
    run.stop_after_controller = &end_asked;
    if (serial) run.serial = [&serial](std::span<const std::uint8_t> bytes) { serial->write(bytes); };
    run.progress = [&](const RobotOnBus& watched) {
      const char* phase = watched.walk_time_s() ? kReleased : kHanging;
      progress.change(end_asked.load() ? kEnding : phase);
      progress.update(watched.walk_time_s().value_or(0.0));
    };
    std::optional<host_telemetry::SimulationPublisher> publisher;
    if (options.publish) publisher.emplace(options.network);
    run.watch = [&](const RobotOnBus& watched) {
      if (publisher) publisher->offer(truth_of(watched, hardware.setup.pushes));
      hands.serve(robot);
    };
    outcome =
        options.lockstep ? run_lockstep(robot, buses, frames, run) : run_realtime(robot, buses, frames, run);
  }
  robot.finish();
  log::RunRecord record = robot.recorder().record();
  record.command_line = command_line;
  describe_run(hardware.robot->constants, robot.plant(), hardware.setup.plant, record);
  write_robot_results(options, robot, record, outcome, frames);
  return options.hang || record.summary.survived ? 0 : 1;
}

}  // namespace stilt::cli
