#include "host_tools/recording/replay/replay_run.h"

#include <algorithm>
#include <expected>
#include <memory>
#include <string>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/live.h"
#include "firmware/program/configure_controller.h"
#include "firmware/robots/robots.h"

namespace stilt::replay {
namespace {

constexpr std::uint64_t kProgressEvery = 1000;

/// The live tunables of a run by their numbers, computed as in stiltd (firmware/telemetry/tuner.h).
class TuningsOf {
 public:
  TuningsOf(const RecordedRun& run, const configuration::Configuration& configuration)
      : run_(run),
        configuration_(configuration),
        robot_(&robots::find(configuration.hardware.robot).value()->model),
        work_(std::make_unique<sqp::TerminalCostWorkspace>()) {}

  [[nodiscard]] std::expected<Tunings, std::string> operator()(std::uint32_t number) const {
    const auto values = run_.tunings.find(number);
    if (values == run_.tunings.end()) return std::unexpected("is missing in the record");
    if (run_.attached) return std::unexpected("has keys that are damaged in the record");
    if (!same_tunables()) {
      return std::unexpected("is of a program with other live tunables; replay it with stilt of " +
                             run_.build);
    }
    Tunings tunings;
    const configuration::Configuration changed =
        configuration::with_live_values(configuration_, values->second);
    const auto status = control::prepare_settings(*robot_, changed, *work_, tunings.planner.settings);
    if (status != control::ConfigureStatus::ok) {
      return std::unexpected("is refused by this program");
    }
    tunings.torque = {number, tunings.planner.settings.parameters.torque_law};
    tunings.planner.number = number;
    return tunings;
  }

 private:
  [[nodiscard]] bool same_tunables() const {
    const auto mine = configuration::live_tunables(configuration_);
    return std::ranges::equal(mine, run_.tunables, [](const auto& tunable, const auto& key) {
      return tunable.entry->name() == key;
    });
  }

  const RecordedRun& run_;
  const configuration::Configuration& configuration_;
  const model::RobotModel* robot_;
  std::unique_ptr<sqp::TerminalCostWorkspace> work_;
};

Outcome failed(const std::string& problem) {
  Outcome outcome;
  outcome.problem = problem;
  return outcome;
}

}  // namespace

Outcome replay_run(const std::string& path, const RecordedRun& run,
                   const std::function<void(std::uint64_t)>& progress) {
  if (!run.configured) {
    return failed("its configuration is missing in the record; " + run.why_not_configured);
  }
  if (const auto robot = robots::of_run(run.robot, run.urdf); !robot) {
    return failed("its robot's description is refused by this program: " + robot.error());
  }
  const auto configuration = configuration_of(run);
  if (!configuration) return failed(configuration.error());
  const TuningsOf tunings(run, *configuration);
  const auto gaits = std::make_unique<gait::GaitLibrary>();
  Replay replay(run.cycles, [&](std::uint32_t number) { return tunings(number); });
  const auto ready = program::configure_controller(*configuration, std::string(kRecordedConfiguration),
                                                   replay.planner(), replay.loop(), gaits.get());
  if (!ready) return failed(ready.error());
  for_each_tick(path, run.number, [&](const control_loop::TickRecord& tick) {
    if (progress && tick.tick % kProgressEvery == 0) progress(tick.tick);
    return replay.run(tick);
  });
  Outcome outcome = replay.outcome();
  if (outcome.ticks == 0 && !outcome.difference && outcome.problem.empty()) {
    outcome.problem = "the record holds no ticks of it";
  }
  return outcome;
}

}  // namespace stilt::replay
