#include "host_tools/cli/report_command.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware/configuration/configuration.h"
#include "host_tools/cli/controller_choice.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/robot_drawing.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/recording/run/record_run.h"
#include "host_tools/recording/run/text_run.h"
#include "host_tools/simulation/plant/number.h"
#include "host_tools/web/report/comparison_page.h"
#include "host_tools/web/report/report.h"
#include "host_tools/web/report/run_data.h"

namespace stilt::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestShift_s = 1e6;

/// What a file holds, and whether all of it could be read.
struct Input {
  log::RunRecord run;  ///< unless it is a page
  std::string page;    ///< data of a page of one run
  bool complete = true;
};

/// The first bytes of a file, by which its kind is known.
std::string start_of(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(16, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream.is_open() || stream.bad() || fs::is_directory(file)) {
    const char* reason = fs::is_directory(file) ? "it is a folder" : std::strerror(errno);
    throw UsageError(file + ": cannot be read (" + reason + "); name a file of a run");
  }
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

Input read_page(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  Input input;
  input.page = report::data_of_page(text.str());
  if (input.page.empty() || input.page.starts_with(R"({"names")")) {
    throw UsageError(file +
                     ": is no report of one run; name a record, or a page of --report or stilt report");
  }
  return input;
}

bool is_samples(const std::string& start) { return start.starts_with("{"); }
bool is_ticks(const std::string& start) { return start.starts_with("tick,"); }

/// The run of a record, or of a file of text, which does not name its robot.
record::RecordRun read_run(const std::string& file, const std::string& start, const std::string& robot) {
  if (start.starts_with("\x89MCAP")) return record::run_of_record(file);
  const model::RobotConstants& constants =
      robot_model(robot.empty() ? std::string(configuration::kDefaultRobot) : robot).constants;
  if (is_samples(start)) return record::run_of_samples(file, constants);
  if (is_ticks(start)) return record::run_of_ticks(file, constants);
  throw UsageError(
      file +
      ": is no file of a run; name a record of stilt record, samples of --log, a black box of stiltd "
      "or a report");
}

Input read(const std::string& file, const std::string& robot) {
  const std::string start = start_of(file);
  if (start.starts_with("<!DOCTYPE html>")) return read_page(file);
  record::RecordRun recorded = read_run(file, start, robot);
  for (const std::string& problem : recorded.problems) std::fprintf(stderr, "stilt: %s\n", problem.c_str());
  if (recorded.runs > 1) {
    std::fprintf(stderr, "stilt: %s: holds %zu runs of stiltd; the report is of the longest\n", file.c_str(),
                 recorded.runs);
  }
  Input input;
  input.run = std::move(recorded.run);
  const std::string name = input.run.robot.name;
  input.run.robot = drawing_of(recorded.robot);
  input.run.robot.name = name;
  std::ranges::copy(recorded.robot.torque_limit_Nm, input.run.torque_limit_Nm);
  input.complete = recorded.problems.empty();
  return input;
}

report::ComparedRun compared(const std::string& file, const Input& input) {
  return {file, input.page.empty() ? report::run_data_json(input.run) : input.page};
}

/// Refuses options that would change nothing.
void check_use(const ReportOptions& options) {
  if (options.shift_s && !std::isfinite(*options.shift_s)) {
    throw UsageError("--shift: must be a number of seconds");
  }
  if (options.shift_s && std::abs(*options.shift_s) > kLongestShift_s) {
    throw UsageError("--shift " + simulation::number_text(*options.shift_s) +
                     ": must lie within 1000000 s either way");
  }
  if (options.shift_s && options.files.size() == 1) {
    throw UsageError("--shift " + simulation::number_text(*options.shift_s) + ": needs a second file");
  }
  const auto needs_robot = [](const std::string& file) {
    const std::string start = start_of(file);
    return is_samples(start) || is_ticks(start);
  };
  if (!options.robot.empty() && std::ranges::none_of(options.files, needs_robot)) {
    throw UsageError("--robot " + options.robot +
                     ": needs samples or a black box; a record and a report name "
                     "their robot");
  }
}

/// Beside the first file, with the names of both.
std::string default_out(const std::vector<std::string>& files) {
  const fs::path first = files.front();
  std::string name = first.stem().string();
  if (files.size() > 1) name += "_" + fs::path(files[1]).stem().string();
  return (first.parent_path() / (name + ".html")).string();
}

/// A page under the default name replaces none: `--report walk.html` of a simulation has the name that
/// walk.mcap gets.
void check_new(const std::string& out) {
  if (fs::exists(out)) throw UsageError(out + ": exists; name another with --out");
}

}  // namespace

CLI::App* add_report_command(CLI::App& program, ReportOptions& options) {
  CLI::App* command =
      program.add_subcommand("report", "make a page of a recorded run, or of two runs side by side");
  command
      ->add_option(
          "FILE", options.files,
          "a record of stilt record, samples of --log, a black box of stiltd or a report; two files: "
          "both in one page")
      ->required()
      ->expected(1, 2);
  command->add_option(
      "--out", options.out,
      "writes the page here, HTML; default: a new file beside the first one, with the names of the files");
  command
      ->add_option("--robot", options.robot,
                   "the robot of samples and of a black box, which do not name it: " + robot_help())
      ->default_str(std::string(configuration::kDefaultRobot));
  command->add_option("--shift", options.shift_s, "added to the times of the second file, s")
      ->default_str("0");
  command->footer(
      "Exit status: 0 done, 1 a file lacks ticks, was cut off or is damaged (the rest is shown), 2 bad "
      "usage.");
  return command;
}

int run_report(const ReportOptions& options) {
  const std::string out = options.out.empty() ? default_out(options.files) : options.out;
  std::vector<std::string> inputs = files_read(CommandInputs{options.robot, "", "", ""});
  inputs.insert(inputs.end(), options.files.begin(), options.files.end());
  check_output_files({{"--out", out}}, inputs);
  check_use(options);
  if (options.out.empty()) check_new(out);
  const Input first = read(options.files[0], options.robot);
  if (options.files.size() == 1) {
    if (!first.page.empty()) {
      throw UsageError(options.files[0] +
                       ": is a report already; name a record, or a second file to compare with");
    }
    write_output_file("--out", out, report::render_report(first.run));
    return first.complete ? 0 : 1;
  }
  const Input second = read(options.files[1], options.robot);
  write_output_file(
      "--out", out,
      report::render_comparison({compared(options.files[0], first), compared(options.files[1], second)},
                                options.shift_s.value_or(0.0)));
  return first.complete && second.complete ? 0 : 1;
}

}  // namespace stilt::cli
