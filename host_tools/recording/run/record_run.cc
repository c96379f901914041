#include "host_tools/recording/run/record_run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "firmware/configuration/configuration.h"
#include "firmware/robots/robots.h"
#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/mcap/reader.h"
#include "host_tools/recording/record/record_version.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/recording/replay/record_file.h"
#include "host_tools/recording/run/plan_track.h"
#include "host_tools/recording/run/settings.h"
#include "host_tools/recording/run/tick_run.h"
#include "host_tools/simulation/closed_loop/run_recorder.h"

namespace stilt::record {
namespace {

/// Messages of a run besides its ticks and what read_contents() takes.
struct RunMessages {
  PlanTrack plans;
  std::map<std::uint64_t, log::RunEvent> events;  ///< by number
  long long heap_allocations = 0;
};

template <class T>
telemetry::Owned<T> message_of(const mcap::ReadMessage& read, const telemetry::Topic& topic) {
  if (topic_of_record(read.channel->topic) != &topic) return {nullptr, telemetry::internal::Free{nullptr}};
  return telemetry::decode<T>(std::as_bytes(read.message.data));
}

RunMessages messages_of(const std::string& path, std::uint64_t run_id) {
  RunMessages found;
  mcap::Reader reader(path);
  while (const mcap::ReadMessage* read = reader.next()) {
    if (const auto plan = message_of<telemetry::Plan>(*read, telemetry::kPlans)) {
      if (plan->run_id == run_id) found.plans.add(*plan);
    } else if (const auto event = message_of<telemetry::Event>(*read, telemetry::kEvents)) {
      if (event->run_id == run_id) found.events[event->number] = {event->time_s, event->text};
    } else if (const auto timing = message_of<telemetry::Timing>(*read, telemetry::kTiming)) {
      if (timing->run_id == run_id) found.heap_allocations = static_cast<long long>(timing->heap_allocations);
    }
  }
  return found;
}

void add_solves(const replay::RecordedRun& recorded, log::RunRecord& run) {
  log::RunSummary& summary = run.summary;
  std::vector<double> times_us;
  double iterations = 0.0;
  for (const control_loop::CycleRecord& cycle : recorded.cycles) {
    // Lock-step measures no times.
    const double solve_us = cycle.solve_ns > 0 ? 1e-3 * static_cast<double>(cycle.solve_ns) : kUnknown;
    run.solves.push_back({cycle.time_s, solve_us, cycle.report});
    if (cycle.solve_ns > 0) times_us.push_back(solve_us);
    iterations += cycle.report.iterations;
    summary.sqp_iterations_max = std::max(summary.sqp_iterations_max, cycle.report.iterations);
    summary.dynamics_defect_max = std::max(summary.dynamics_defect_max, cycle.report.dynamics_defect_max);
    summary.equality_violation_max =
        std::max(summary.equality_violation_max, cycle.report.equality_violation_max);
  }
  summary.solve_time_us =
      times_us.empty() ? log::Percentiles{kUnknown, kUnknown, kUnknown} : simulation::percentiles(times_us);
  if (!run.solves.empty()) summary.sqp_iterations_mean = iterations / static_cast<double>(run.solves.size());
}

model::RobotConstants robot_of(const std::string& path, const replay::RecordedRun& run) {
  const auto found = robots::of_run(run.robot, run.urdf);
  if (found) return (*found)->model.constants;
  throw std::runtime_error(path +
                           (run.urdf.empty() ? ": the record has no URDF of its robot: "
                                             : ": the URDF of its robot is refused by this program: ") +
                           found.error());
}

/// Clock of the ticks at tick 0. Where the message that has it is damaged, back from the first tick there is.
std::int64_t start_of(const std::string& path, const replay::RecordedRun& run, double rate_hz) {
  if (!run.attached) return run.start_clock_ns;
  std::int64_t start_ns = 0;
  replay::for_each_tick(path, run.number, [&](const control_loop::TickRecord& tick) {
    start_ns = tick.time_ns - std::llround(1e9 / rate_hz * static_cast<double>(tick.tick));
    return false;
  });
  return start_ns;
}

}  // namespace

RecordRun run_of_record(const std::string& path) {
  const replay::RecordContents contents = replay::read_contents(path);
  const auto recorded = std::ranges::max_element(
      contents.runs, {}, [](const replay::RecordedRun& run) { return run.ticks.count(); });
  if (recorded == contents.runs.end() || recorded->ticks.empty()) {
    throw std::runtime_error(without_ticks(path, contents.problems));
  }
  if (!recorded->configured) {
    throw std::runtime_error(path + ": lacks the configuration of its run; " + recorded->why_not_configured);
  }
  const RunMessages messages = messages_of(path, recorded->number);
  RecordRun result;
  result.robot = robot_of(path, *recorded);
  result.runs = contents.runs.size();
  result.problems = contents.problems;
  if (recorded->ticks.has_break()) {
    result.problems.push_back(path + ": " + recorded->ticks.text() + kBreakInPlots);
  }
  log::RunRecord& run = result.run;
  run.command_line = path + ", recorded from stiltd " + recorded->build;
  run.controller.emplace();
  for (const auto& [number, event] : messages.events) run.controller->events.push_back(event);
  double rate_hz = control::TimingParameters{}.torque_rate_hz;
  if (const auto configuration = replay::configuration_of(*recorded)) {
    rate_hz = configuration->timing.torque_rate_hz;
    run.friction_coefficient = configuration->inequality.friction_coefficient;
    run.settings = settings_of(*configuration);
    run.allowed_torque_Nm = allowed_torque_Nm(*configuration, result.robot);
  } else {
    result.problems.push_back(path + ": " + configuration.error() +
                              "; the run is read without its limits and settings");
  }
  run.settings.insert(run.settings.begin(), {{"robot", recorded->robot}, {"stiltd", recorded->build}});
  run.robot.name = recorded->robot;
  run.plans = messages.plans.snapshots();
  TickRun ticks(result.robot, start_of(path, *recorded, rate_hz), messages.plans, run);
  replay::for_each_tick(path, recorded->number, [&](const control_loop::TickRecord& tick) {
    ticks.add(tick);
    return true;
  });
  ticks.finish();
  add_solves(*recorded, run);
  run.summary.heap_allocations_in_loop = messages.heap_allocations;
  return result;
}

}  // namespace stilt::record
