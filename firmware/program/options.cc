#include "firmware/program/options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/commissioning/jog.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/output_file.h"
#include "firmware/program/configuration_choice.h"
#include "firmware/program/examples.h"
#include "firmware/program/instruction_sets.h"
#include "firmware/program/option_checks.h"
#include "firmware/program/usage_text.h"

namespace stilt::program {
namespace {

constexpr double kLargestSpeed_m_s = 5.0;
constexpr double kLongestRun_s = 86400.0;
constexpr double kLeastTorqueShare = 0.05;

// clang-format off
constexpr std::array kExamples = {
    "stiltd --config robot.toml --check-config",
    "stiltd --config robot.toml --json run.json --black-box fault.csv",
    "stiltd --bus loopback:left --bus loopback:right --start walk@0.5 --duration 30",
    "stiltd scan --config robot.toml",
    "stiltd watch --config robot.toml --duration 20",
    "stiltd jog hip_L 0.3 --config robot.toml",
    "stiltd zero hip_L --config robot.toml",
    "stiltd calibrate --config robot.toml --out robot.toml",
    "stiltd identify --config robot.toml --torque-limit 0.3 --out robot.toml",
    "stiltd selftest --config robot.toml --seconds 10",
    "stiltd interrupts can0 can1",
};
// clang-format on

/// The arguments of the command line before they mean anything.
struct Arguments {
  ConfigurationChoice configuration;
  std::string start;
  bool check_config = false;
  bool print_config = false;
  std::string joint;
  std::string reference = "stops";
  std::optional<double> torque_share;  ///< of --torque-limit, before a command or behind it
};

/// The subcommands of a command line.
struct Commands {
  CLI::App* self_test = nullptr;
  CLI::App* scan = nullptr;
  CLI::App* watch = nullptr;
  CLI::App* jog = nullptr;
  CLI::App* zero = nullptr;
  CLI::App* calibrate = nullptr;
  CLI::App* identify = nullptr;
  CLI::App* interrupts = nullptr;
};

std::string shortest(double number) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

/// The share of --torque-limit is one of the configured limit.
void limit_torque(Options& options) {
  configuration::Configuration& configuration = options.configuration;
  configuration.supervisor.torque_limit_share *= options.torque_limit_share;
  configuration.supervisor.plan_torque_share = configuration.robot.torque_limit_scale;
  configuration::keep_torque_limit(configuration);
  if (options.torque_limit_share == 1.0) return;
  options.source += ", --torque-limit " + shortest(options.torque_limit_share);
}

std::expected<void, std::string> check_start(const Options& options) {
  if (!options.start || options.start->kind == gait::GaitKind::stand) return {};
  char text[250];
  const double limit_m_s = options.configuration.telemetry.speed_limit_m_s;
  if (std::abs(options.start->speed_m_s) > limit_m_s) {
    std::snprintf(text, sizeof text, "--start: %g m/s is beyond telemetry.speed_limit_m_s, %g m/s either way",
                  options.start->speed_m_s, limit_m_s);
    return std::unexpected(text);
  }
  const supervisor::SupervisorParameters& supervisor = options.configuration.supervisor;
  if (supervisor::may_walk(supervisor)) return {};
  const char* key = supervisor::key_against_walk(supervisor);
  const bool enough_without_option =
      supervisor.torque_limit_share >= supervisor.walk_torque_share * options.torque_limit_share;
  if (enough_without_option && supervisor.torque_limit_share < supervisor.walk_torque_share) {
    key = "--torque-limit";
  }
  std::snprintf(text, sizeof text,
                "--start: stepping and walking need a torque limit of at least %g of the joints' "
                "(supervisor.walk_torque_share), and it is %g; take --start stand, or a larger %s",
                supervisor.walk_torque_share, supervisor::torque_share_of_walk(supervisor), key);
  return std::unexpected(text);
}

/// A subcommand that commands the robot instead of the controller.
CLI::App* add_command(CLI::App& app, const char* name, const char* description, Arguments& arguments,
                      Options& options) {
  CLI::App* command = app.add_subcommand(name, description);
  add_configuration_options(*command, arguments.configuration);
  command->add_flag("--lockstep", options.lockstep,
                    "takes turns with a simulated robot instead of following the clock");
  command->add_option("--json", options.json_file, "writes the results as JSON, - for standard output");
  return command;
}

void add_answers(CLI::App& command, Options& options) {
  command.add_option("--answers", options.answers_file,
                     "a file with the answers, one per line, instead of standard input");
}

void add_out(CLI::App& command, Options& options) {
  command.add_option("--out", options.out_file,
                     "writes what was found to this configuration: changes it, comments stay, or makes it of "
                     "the one that was read");
}

Commands add_commands(CLI::App& app, Arguments& arguments, Options& options) {
  Commands commands;
  commands.scan = add_command(app, "scan", "finds the drivers and sensors on the buses; enables nothing",
                              arguments, options);
  commands.watch = add_command(app, "watch",
                               "shows joints, torso and emergency stop; drivers up, at zero torque and gains",
                               arguments, options);
  commands.watch->add_option("--duration", options.duration_s, "ends after this time, s; 0: when stopped");
  commands.jog = add_command(app, "jog",
                             "moves one joint slowly with at most 20 % of its torque, asks which link moved, "
                             "and names what is wired wrong",
                             arguments, options);
  commands.jog->add_option("joint", arguments.joint, "hip_L, knee_L, hip_R or knee_R")->required();
  commands.jog->add_option("angle", options.jog_angle_rad, "from where it hangs, rad: 0.08 to 0.5 either way")
      ->required();
  add_answers(*commands.jog, options);
  commands.zero = add_command(app, "zero",
                              "makes the position in which a joint is held the zero of its driver, where the "
                              "driver can; motors off",
                              arguments, options);
  commands.zero->add_option("joint", arguments.joint, "hip_L, knee_L, hip_R or knee_R")->required();
  commands.calibrate = add_command(app, "calibrate",
                                   "offsets of joints that a person moves to end stops or marks, their signs "
                                   "again, and the torso sensor against gravity; no torque",
                                   arguments, options);
  commands.calibrate
      ->add_option("--at", arguments.reference,
                   "stops: both end stops of each joint; marks: alignment marks at angle 0, links in line")
      ->check(CLI::IsMember({"stops", "marks"}))
      ->capture_default_str();
  add_answers(*commands.calibrate, options);
  add_out(*commands.calibrate, options);
  commands.identify = add_command(app, "identify",
                                  "friction, armature and torque constant of each drive, from slow and "
                                  "quick motions of one joint after the other on the gantry",
                                  arguments, options);
  commands.identify
      ->add_option("--torque-limit", arguments.torque_share,
                   "share of the joints' torque limits that may be used, 0.05 to 1")
      ->default_str(shortest(options.identify_torque_share));
  add_out(*commands.identify, options);
  commands.self_test =
      add_command(app, "selftest", "commands all drivers at zero torque, reports replies and their times",
                  arguments, options);
  commands.self_test->add_option("--seconds", options.self_test_s, "how long, s")->capture_default_str();
  commands.self_test->add_flag("--hanging", options.hangs,
                               "the robot hangs, legs limp: fails where angles and pitch are not plumb");
  commands.self_test->add_flag("--accept-missing-stop", options.accept_missing_stop,
                               "passes although no emergency stop is reported to this program");
  commands.interrupts = app.add_subcommand(
      "interrupts", "as root: puts the interrupt threads of the buses between planner and torque loop");
  add_configuration_options(*commands.interrupts, arguments.configuration);
  commands.interrupts->add_option("interface", options.interrupt_buses,
                                  "can0, ...; without one, those of the configuration");
  return commands;
}

std::expected<void, std::string> interpret_joint(const char* command, const Arguments& arguments,
                                                 Options& options) {
  const auto& names = control_loop::kJointNames;
  const auto joint = std::ranges::find(names, arguments.joint);
  if (joint == names.end()) {
    return std::unexpected(std::string(command) + ": \"" + arguments.joint +
                           "\" is no joint; right are hip_L, knee_L, hip_R and knee_R");
  }
  options.joint = static_cast<std::size_t>(joint - names.begin());
  return {};
}

std::expected<void, std::string> interpret_jog(const Arguments& arguments, Options& options) {
  if (const auto right = interpret_joint("jog", arguments, options); !right) return right;
  const double angle_rad = std::abs(options.jog_angle_rad);
  if (!(angle_rad >= commissioning::kSmallestJog_rad && angle_rad <= commissioning::kLargestJog_rad)) {
    return std::unexpected("jog: the angle must be 0.08 to 0.5 rad, either way");
  }
  return {};
}

Task task_of(const Commands& commands) {
  if (commands.self_test->parsed()) return Task::self_test;
  if (commands.scan->parsed()) return Task::scan;
  if (commands.watch->parsed()) return Task::watch;
  if (commands.jog->parsed()) return Task::jog;
  if (commands.zero->parsed()) return Task::zero;
  if (commands.calibrate->parsed()) return Task::calibrate;
  if (commands.identify->parsed()) return Task::identify;
  if (commands.interrupts->parsed()) return Task::interrupts;
  return Task::control;
}

/// File of an option of a command line that is refused before its options are known; empty: none. Another
/// option is no file.
std::string file_of(std::string_view option, std::span<char* const> words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word.starts_with(option) && word.substr(option.size()).starts_with('=')) {
      return std::string(word.substr(option.size() + 1));
    }
    if (word != option || i + 1 == words.size()) continue;
    const std::string_view file = words[i + 1];
    if (file == "-" || !file.starts_with("-")) return std::string(file);
  }
  return "";
}

std::expected<void, std::string> interpret(const CLI::App& app, const Arguments& arguments,
                                           const Commands& commands, Options& options) {
  options.task = task_of(commands);
  options.config_file = arguments.configuration.file;
  if (const auto right = check_options_before(app); !right) return right;
  if (const auto right = check_options_of_reports(app); !right) return right;
  if (arguments.reference == "marks") options.reference = commissioning::Reference::marks;
  if (options.task == Task::jog) {
    if (const auto right = interpret_jog(arguments, options); !right) return right;
  }
  if (options.task == Task::zero) {
    if (const auto right = interpret_joint("zero", arguments, options); !right) return right;
  }
  if (arguments.check_config) options.task = Task::check_config;
  if (arguments.print_config) options.task = Task::print_config;
  if (!arguments.start.empty()) {
    const auto start = parse_start(arguments.start);
    if (!start) return std::unexpected(start.error());
    options.start = *start;
  }
  if (!(options.duration_s >= 0.0 && options.duration_s <= kLongestRun_s)) {
    return std::unexpected("--duration: must be 0 (until stopped) to 86400 s");
  }
  if (!(options.self_test_s > 0.0 && options.self_test_s <= kLongestRun_s)) {
    return std::unexpected("--seconds: must be above 0 and at most 86400 s");
  }
  double& share = options.task == Task::identify ? options.identify_torque_share : options.torque_limit_share;
  share = arguments.torque_share.value_or(share);
  if (!(share >= kLeastTorqueShare && share <= 1.0)) {
    return std::unexpected("--torque-limit: must be a share of the torque, 0.05 to 1");
  }
  std::expected<ChosenConfiguration, std::string> chosen =
      options.task == Task::print_config ? written_configuration(arguments.configuration)
                                         : read_configuration(arguments.configuration);
  if (!chosen) return std::unexpected(chosen.error());
  options.configuration = chosen->configuration;
  options.source = std::move(chosen->source);
  options.changed_keys = std::move(chosen->changed_keys);
  if (options.task == Task::print_config) return {};
  limit_torque(options);
  if (options.task == Task::control || options.task == Task::check_config)
    choose_instruction_set(options.configuration);
  return check_start(options);
}

/// Whether a file is there whose first character begins no JSON object. Devices and empty files hold nothing.
bool holds_other_than_json(const std::string& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  std::ifstream stream(file);
  const int first = stream.get();
  return !stream.is_open() || (first != std::ifstream::traits_type::eof() && first != '{');
}

}  // namespace

std::expected<gait::GaitCommand, std::string> parse_start(const std::string& text) {
  const std::size_t at = text.find('@');
  const std::string_view gait = std::string_view(text).substr(0, at);
  const std::string_view speed = at == std::string::npos ? "" : std::string_view(text).substr(at + 1);
  gait::GaitCommand command;
  const auto read = std::from_chars(speed.data(), speed.data() + speed.size(), command.speed_m_s);
  const bool has_speed = !speed.empty() && read.ec == std::errc{} && read.ptr == speed.data() + speed.size();
  if (gait == "walk") command.kind = gait::GaitKind::walk;
  if (gait == "step") command.kind = gait::GaitKind::step;
  const bool known = gait == "stand" || gait == "step" || gait == "walk";
  if (known && has_speed && gait != "walk") {
    return std::unexpected("--start " + text + ": a speed belongs to a walk; take --start " +
                           std::string(gait) + ", or a walk such as walk@0.3");
  }
  if (!known || (at != std::string::npos && !has_speed) || (gait == "walk" && !has_speed) ||
      !(std::abs(command.speed_m_s) <= kLargestSpeed_m_s)) {
    return std::unexpected(
        "--start " + text +
        ": expected stand, step, or walk@SPEED with a speed within 5 m/s either way, such as "
        "walk@0.5");
  }
  return command;
}

std::expected<void, std::string> read_options(int argc, char** argv, const std::string& version,
                                              Options& options) {
  CLI::App app{"Controller of a planar walking robot: plans its motion and drives its motors over CAN.",
               "stiltd"};
  app.set_version_flag("--version", version);
  Arguments arguments;
  add_configuration_options(app, arguments.configuration);
  app.add_option("--start", arguments.start,
                 "goes there without an operator: stand, step or walk@SPEED (m/s); without it, waits idle");
  app.add_option("--duration", options.duration_s, "sits down and ends after this time, s; 0: never");
  app.add_option("--torque-limit", arguments.torque_share,
                 "share of supervisor.torque_limit_share that may be used, 0.05 to 1, for first days; below "
                 "supervisor.walk_torque_share the robot stands and does not walk");
  app.add_flag("--lockstep", options.lockstep,
               "takes turns with a simulated robot instead of following the clock");
  app.add_option("--json", options.json_file, "writes statistics at the end as JSON, - for standard output");
  app.add_option("--black-box", options.black_box_file,
                 "writes the ticks around the fault with the hardest reaction to this file, CSV");
  app.add_flag(
      "--forbid-syscalls", options.forbid_syscalls,
      "for tests: ends at once when a real-time thread uses the heap, or a system call that can make it "
      "wait");
  app.add_option("--planner-until", options.planner_until_s,
                 "for tests: the planner stops working at this time, s; 0: never");
  app.add_flag("--check-config", arguments.check_config, "reads the configuration, reports on it, and ends");
  app.add_flag("--print-config", arguments.print_config, "prints the configuration with every key, and ends");
  const Commands commands = add_commands(app, arguments, options);
  app.require_subcommand(0, 1);
  app.footer(
      "Exit status: 0 ended as requested, 1 a fault stopped the robot, --start was not reached or a check "
      "failed, 2 bad "
      "usage.");
  add_examples(app, kExamples);
  try {
    parse(app, {argv + 1, argv + argc});
  } catch (const CLI::Success& help_or_version) {
    app.exit(help_or_version);
    options.task = Task::nothing;
    return {};
  } catch (const CLI::ParseError& error) {
    options.refused = true;
    options.task = task_of(commands);
    options.json_file = file_of("--json", {argv + 1, argv + argc});
    options.config_file = file_of("--config", {argv + 1, argv + argc});
    return std::unexpected(usage_text(app, error));
  }
  const auto right = interpret(app, arguments, commands, options);
  options.refused = !right;
  return right;
}

std::string file_conflict(const Options& options) {
  const auto outputs = std::to_array<diagnostics::NamedFile>(
      {{"--json", options.json_file}, {"--black-box", options.black_box_file}});
  std::vector<std::string> inputs = configuration::files_of_robot(options.configuration.hardware.robot);
  inputs.insert(inputs.end(), {options.config_file, options.out_file, options.answers_file});
  if (options.refused && holds_other_than_json(options.json_file)) inputs.push_back(options.json_file);
  return diagnostics::conflict(outputs, inputs);
}

}  // namespace stilt::program
