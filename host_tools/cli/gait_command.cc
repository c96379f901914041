#include "host_tools/cli/gait_command.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/gaits/gait_file.h"
#include "host_tools/cli/controller_choice.h"
#include "host_tools/cli/gait_json.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/progress.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/gait_synthesis/gait_check.h"
#include "host_tools/gait_synthesis/gait_page.h"
#include "host_tools/gait_synthesis/likely_mistake.h"
#include "host_tools/gait_synthesis/synthesize.h"
#include "host_tools/simulation/plant/number.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::cli {
namespace {

using gait_files::GaitRecord;
using gait_synthesis::GaitCheck;
using gait_synthesis::StepTask;
using simulation::number_text;

constexpr double kFastest_m_s = 2.0;

void change_limit(const std::string& assignment, gait_files::GaitLimits& limits) {
  const std::size_t equals = assignment.find('=');
  const std::string key = assignment.substr(0, equals);
  std::string known;
  for (const auto& field : gait_files::limit_fields()) {
    known += (known.empty() ? "" : ", ") + std::string(field.key);
    if (key != field.key || equals == std::string::npos) continue;
    double value = 0.0;
    const char* begin = assignment.data() + equals + 1;
    const char* end = assignment.data() + assignment.size();
    const auto [rest, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || rest != end || !std::isfinite(value) || value < 0.0) {
      throw UsageError("--limit " + assignment + ": the value must be a number of at least 0");
    }
    field.values(limits)[0] = value;
    return;
  }
  throw UsageError("--limit " + assignment + ": KEY=VALUE is expected, with KEY one of " + known);
}

void check_speed(const char* option, double speed_m_s) {
  if (std::isfinite(speed_m_s) && std::abs(speed_m_s) <= kFastest_m_s) return;
  throw UsageError(std::string(option) + " " + number_text(speed_m_s) +
                   ": the speed must be from -2 to 2 m/s");
}

StepTask task_of(const GaitOptions& options) {
  StepTask task;
  check_speed("--speed", options.speed_m_s);
  task.speed_m_s = options.speed_m_s;
  if (!(options.step_time_s >= 0.1 && options.step_time_s <= 1.5)) {
    throw UsageError("--step-time " + number_text(options.step_time_s) +
                     ": the step time must be from 0.1 to 1.5 s");
  }
  task.step_time_s = options.step_time_s;
  if (options.output_degree < gait::kMinOutputDegree || options.output_degree > gait::kMaxOutputDegree) {
    throw UsageError("--degree " + std::to_string(options.output_degree) +
                     ": the degree must be from 4 to 7");
  }
  task.output_degree = options.output_degree;
  const auto cost = gait_synthesis::cost_of_name(options.cost);
  if (!cost) {
    throw UsageError("--cost " + options.cost + ": no such cost; known are torque, power, acceleration");
  }
  task.cost = *cost;
  task.phase = gait_synthesis::phase_for_speed(task.speed_m_s);
  if (options.phase == "time") {
    task.phase = gait::PhaseKind::time;
  } else if (options.phase == "hip") {
    if (task.speed_m_s == 0.0)
      throw UsageError("--phase hip: in place the hip does not advance; use time or auto");
    task.phase = gait::PhaseKind::hip_position;
  } else if (options.phase != "auto") {
    throw UsageError("--phase " + options.phase + ": no such phase; known are auto, hip, time");
  }
  for (const std::string& limit : options.limits) change_limit(limit, task.limits);
  return task;
}

void print(const GaitRecord& record, const GaitCheck& check) {
  const gait_files::GaitMetrics& f = check.metrics;
  std::printf("%s, %.3f m/s: step %.4f m in %.4f s, phase by %s\n", record.robot.c_str(),
              record.gait.speed_m_s, record.gait.step_length_m, record.gait.step_time_s,
              record.gait.outputs.phase == gait::PhaseKind::time ? "time" : "hip position");
  std::printf("  defect %.1e, periodicity %.1e, replay %.1e, largest eigenvalue %.3f\n", f.defect_max,
              f.periodicity_error, f.replay_error_max, f.return_map_eigenvalues[0]);
  std::printf("  torque at most %.1f %.1f %.1f %.1f Nm, friction ratio %.3f, clearance %.3f m\n",
              f.peak_torque_Nm[0], f.peak_torque_Nm[1], f.peak_torque_Nm[2], f.peak_torque_Nm[3],
              f.friction_ratio_max, f.clearance_m);
  std::printf("  touch-down at %.3f m/s, slip %.3f m/s, outputs within %.1e rad\n", f.touchdown_speed_m_s,
              f.touchdown_slip_m_s, f.output_error_max_rad);
  std::printf("  %s\n", check.valid() ? "valid" : "not valid:");
  for (const gait_synthesis::Violation& violation : check.violations) {
    std::printf("    %s\n", violation.text().c_str());
  }
}

OutputFiles outputs_of(const GaitOptions& options) {
  return {{"--out", options.out}, {"--report", options.report_file}, {"--json", options.json_file}};
}

/// Prints text or JSON as requested, and calls `write`, which writes another file. Returns the exit status.
int report(
    const GaitRecord& record, const GaitCheck& check, const GaitOptions& options,
    const std::function<void()>& write = [] {}) {
  if (!on_standard_output(outputs_of(options))) print(record, check);
  write_each({write, [&] {
                if (!options.json_file.empty()) write_json(to_json(record, check), options.json_file);
              }});
  return check.valid() ? 0 : 1;
}

/// The robot of a gait.
const model::RobotModel& gait_robot(const std::string& name) {
  const model::RobotModel& robot = robot_model(name);
  if (const std::string unequal = gait_synthesis::unequal_legs(robot.constants); !unequal.empty()) {
    throw UsageError(unequal);
  }
  return robot;
}

GaitRecord load(const std::string& file, const model::RobotModel** robot) {
  auto record = gait_files::load_gait(file);
  if (!record) throw UsageError(record.error());
  *robot = &gait_robot(record->robot);
  return std::move(*record);
}

/// The record of a file. Completes the motion of a file that has only outputs.
GaitRecord load_complete(const std::string& file, const model::RobotModel** robot) {
  GaitRecord record = load(file, robot);
  if (record.gait.motion.degree > 0) return record;
  try {
    gait_synthesis::complete_motion(**robot, record.gait);
  } catch (const std::runtime_error& error) {
    const auto mistake = gait_synthesis::likely_mistake(**robot, record.gait);
    throw UsageError(
        file + ": " + error.what() +
        (mistake ? "; there is one when " + *mistake : "; check units, signs and order of the joints") +
        " (docs/gaits.md)");
  }
  return record;
}

/// Of --out.
void write_gait(GaitRecord record, const std::string& file) {
  record.robot = configuration::robot_in_file(file, record.robot);
  write_output_file("--out", file, gait_files::to_toml(record));
}

/// What a gait that was found lacks besides its limits, on standard error.
void advise(const GaitCheck& check) {
  std::string names;
  for (const gait_synthesis::Violation& violation : check.violations) {
    if (violation.accuracy) names += (names.empty() ? "" : ", ") + violation.name;
  }
  if (names.empty()) return;
  std::cerr << "stilt: accuracy of this search, no limits of yours: " << names
            << "; --cost acceleration --degree 5 finds smoother gaits (docs/gaits.md)\n";
}

int synthesize(const GaitOptions& options) {
  const model::RobotModel& robot = gait_robot(options.robot);
  const StepTask task = task_of(options);
  const GaitRecord record = gait_synthesis::make_record(robot, task, gait_synthesis::synthesize(robot, task));
  const GaitCheck result = gait_synthesis::check_gait(robot, record);
  const int status = report(record, result, options, [&] { write_gait(record, options.out); });
  advise(result);
  return status;
}

int check(const GaitOptions& options) {
  const model::RobotModel* robot = nullptr;
  const GaitRecord record = load_complete(options.file, &robot);
  return report(record, gait_synthesis::check_gait(*robot, record), options);
}

int complete(const GaitOptions& options) {
  const model::RobotModel* robot = nullptr;
  GaitRecord record = load_complete(options.file, &robot);
  const GaitCheck result = gait_synthesis::check_gait(*robot, record);
  record.claims = result.metrics;
  return report(record, result, options, [&] { write_gait(record, options.out); });
}

std::string file_name(const std::string& robot, double speed_m_s) {
  return std::filesystem::path(robot).stem().string() + "_" + simulation::decimals_text(speed_m_s) + ".toml";
}

/// Finds the gait of one speed of a library, writes its file and adds its row. Returns the exit status.
int add_gait(const model::RobotModel& robot, const GaitOptions& options, nlohmann::ordered_json& rows) {
  const StepTask task = task_of(options);
  try {
    const GaitRecord record =
        gait_synthesis::make_record(robot, task, gait_synthesis::synthesize(robot, task));
    const GaitCheck result = gait_synthesis::check_gait(robot, record);
    rows.push_back(to_json(record, result));
    if (options.json_file != "-") print(record, result);
    const auto file = std::filesystem::path(options.out) / file_name(record.robot, options.speed_m_s);
    write_gait(record, file.string());
    advise(result);
    return result.valid() ? 0 : 1;
  } catch (const gait_synthesis::NoGait& none) {
    std::cerr << "stilt: " << none.what() << '\n';
    rows.push_back({{"speed_m_s", options.speed_m_s}, {"valid", false}, {"error", none.what()}});
    return 1;
  }
}

/// Gaits from the slowest to the fastest speed.
int gait_count(const GaitOptions& options, double step_m_s) {
  return static_cast<int>(std::floor((options.to_m_s - options.from_m_s) / step_m_s + 1e-9)) + 1;
}

/// A library that holds more could not be loaded.
void check_count(const GaitOptions& options) {
  constexpr int kMost = gait::GaitLibrary::kMaxGaits;
  const int count = gait_count(options, options.step_m_s);
  if (count <= kMost) return;
  constexpr double kRounding_m_s = 0.001;
  double step_m_s = kRounding_m_s * std::ceil((options.to_m_s - options.from_m_s) / kMost / kRounding_m_s);
  while (gait_count(options, step_m_s) > kMost) step_m_s += kRounding_m_s;
  char sentence[200];
  std::snprintf(sentence, sizeof sentence,
                "--step %g: gives %d gaits, and a library holds at most %d; take at least --step %.3f",
                options.step_m_s, count, kMost, step_m_s);
  throw UsageError(sentence);
}

int library(const GaitOptions& options) {
  check_output_folder(options.out);
  check_speed("--from", options.from_m_s);
  check_speed("--to", options.to_m_s);
  if (!(options.step_m_s >= 0.01) || options.to_m_s < options.from_m_s) {
    throw UsageError("--step must be at least 0.01 m/s and --to not below --from");
  }
  check_count(options);
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (!std::filesystem::is_directory(options.out)) {
    throw UsageError("--out " + options.out + ": the folder cannot be made; name one in a writable folder");
  }
  const model::RobotModel& robot = gait_robot(options.robot);
  const int count = gait_count(options, options.step_m_s);
  std::vector<GaitOptions> gaits(static_cast<std::size_t>(count), options);
  for (int i = 0; i < count; ++i) {
    // Rounded, so that 0.1 m/s is 0.1 and standing still is 0.
    double& speed_m_s = gaits[static_cast<std::size_t>(i)].speed_m_s;
    speed_m_s = std::round((options.from_m_s + i * options.step_m_s) * 1e6) / 1e6 + 0.0;
    (void)task_of(gaits[static_cast<std::size_t>(i)]);  // reports errors of the options before any work
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  int status = 0;
  const auto find_all = [&] {
    Progress progress("finding gaits", count, "gaits");
    for (const GaitOptions& one : gaits) {
      status = std::max(status, add_gait(robot, one, rows));
      progress.update(static_cast<double>(rows.size()));
    }
  };
  // What was found before an error is written, too.
  write_each({find_all, [&] {
                if (!options.json_file.empty()) write_json({{"gaits", rows}}, options.json_file);
              }});
  return status;
}

int show(const GaitOptions& options) {
  const model::RobotModel* robot = nullptr;
  const GaitRecord record = load_complete(options.file, &robot);
  const GaitCheck result = gait_synthesis::check_gait(*robot, record);
  return report(record, result, options, [&] {
    write_output_file("--report", options.report_file,
                      gait_synthesis::render_gait_page(*robot, record, result));
  });
}

void add_task_options(CLI::App& command, GaitOptions& options) {
  command.add_option("--robot", options.robot, robot_help())->capture_default_str();
  command.add_option("--step-time", options.step_time_s, "duration of a step, s")->capture_default_str();
  command
      .add_option("--cost", options.cost,
                  "cost per metre to minimise: torque (squared), power, acceleration (squared)")
      ->capture_default_str();
  command
      .add_option("--phase", options.phase,
                  "phase of the outputs: hip (position), time, or auto: hip from 0.15 m/s on")
      ->capture_default_str();
  command.add_option("--degree", options.output_degree, "degree of the outputs, 4 to 7")
      ->capture_default_str();
  command.add_option("--limit", options.limits, "changes a limit of the gait: KEY=VALUE; repeatable")
      ->allow_extra_args(false);
  std::string keys = "Keys of --limit:\n";
  gait_files::GaitLimits defaults;
  for (const auto& field : gait_files::limit_fields()) {
    keys += std::string("  ") + field.key + " (" + number_text(field.values(defaults)[0]) +
            "): " + field.meaning + "\n";
  }
  command.footer(keys + "Exit status: 0 done, 1 no gait found or a limit violated, 2 bad usage.");
}

void add_json_option(CLI::App& command, GaitOptions& options) {
  command
      .add_option("--json", options.json_file,
                  "writes the results as JSON to a file, or - for standard output")
      ->expected(0, 1)
      ->default_str("-");
}

}  // namespace

CLI::App* add_gait_command(CLI::App& program, GaitOptions& options) {
  CLI::App* gait = program.add_subcommand("gait", "find, check and show periodic gaits");
  gait->require_subcommand(1);
  CLI::App* synthesize = gait->add_subcommand("synthesize", "find the gait of one speed");
  synthesize->add_option("--speed", options.speed_m_s, "forward speed, m/s, negative backward")->required();
  synthesize->add_option("--out", options.out, "gait file to write, TOML")->required();
  add_task_options(*synthesize, options);
  CLI::App* check = gait->add_subcommand("check", "recompute every claim of a gait file");
  check->add_option("file", options.file, "gait file")->required();
  CLI::App* complete =
      gait->add_subcommand("complete", "find the motion of an imported file that has only outputs");
  complete->add_option("file", options.file, "gait file with [outputs]")->required();
  complete->add_option("--out", options.out, "gait file to write, TOML")->required();
  CLI::App* library = gait->add_subcommand("library", "find gaits over a range of speeds, one file each");
  library->add_option("--from", options.from_m_s, "slowest speed, m/s")->capture_default_str();
  library->add_option("--to", options.to_m_s, "fastest speed, m/s")->capture_default_str();
  library->add_option("--step", options.step_m_s, "difference between two speeds, m/s")
      ->capture_default_str();
  library->add_option("--out", options.out, "folder of the files")->required();
  add_task_options(*library, options);
  check->footer(
      "Exit status: 0 valid, 1 a limit, tolerance or claim violated, 2 bad usage or no periodic motion.");
  complete->footer(
      "Exit status: 0 written and valid, 1 written and not valid, 2 bad usage or no periodic motion: nothing "
      "written.");
  CLI::App* show = gait->add_subcommand("show", "draw a gait: phase portraits, curves, poses");
  show->add_option("file", options.file, "gait file")->required();
  show->add_option("--report", options.report_file, "page to write, HTML")->required();
  for (CLI::App* command : {synthesize, check, complete, library, show}) add_json_option(*command, options);
  return gait;
}

int run_gait(const CLI::App& gait, GaitOptions options) {
  for (const CLI::App* command : gait.get_subcommands()) {
    const CLI::Option* json = command->get_option("--json");
    if (json->count() > 0 && options.json_file.empty()) options.json_file = "-";
  }
  OutputFiles outputs = outputs_of(options);
  if (gait.got_subcommand("library")) outputs.front().path.clear();  // names a folder
  check_output_files(outputs, files_read(CommandInputs{options.robot, "", "", options.file}));
  try {
    if (gait.got_subcommand("synthesize")) return synthesize(options);
    if (gait.got_subcommand("check")) return check(options);
    if (gait.got_subcommand("complete")) return complete(options);
    if (gait.got_subcommand("library")) return library(options);
    return show(options);
  } catch (const gait_synthesis::NoGait& none) {
    std::cerr << "stilt: " << none.what() << '\n';
    return 1;
  }
}

}  // namespace stilt::cli
