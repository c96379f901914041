// The simulated controller is the one on the robot. A scenario with faults in `stilt sim` and through two
// processes in lock-step changes state, fallback level and faults at the same ticks.
#include <gtest/gtest.h>

#include <ostream>

#include "host_tools/recording/replay/record_file.h"
#include "tests/closed_loop/simulated_run.h"
#include "tests/firmware/supervisor/printers.h"
#include "tests/two_processes/recorder.h"

namespace stilt::two_processes {
namespace {

using control_loop::TickRecord;

/// A tick of the controller at which one of them changes.
struct Change {
  std::uint64_t tick;
  supervisor::State state;
  supervisor::FallbackLevel level;
  std::uint64_t faults;

  bool operator==(const Change&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Change& change) {
  return out << change.tick << " " << name(change.state) << " " << name(change.level) << " faults 0x"
             << std::hex << change.faults << std::dec;
}

/// From the first walking tick to the first in the state fault.
class Changes {
 public:
  void add(const TickRecord& tick) {
    const bool over = !found.empty() && found.back().state == supervisor::State::fault;
    if (over || (found.empty() && tick.state != supervisor::State::walk)) return;
    const Change now{tick.tick, tick.state, tick.level, tick.present.bits()};
    if (found.empty() || found.back().state != now.state || found.back().level != now.level ||
        found.back().faults != now.faults) {
      found.push_back(now);
    }
  }

  std::vector<Change> found;
};

constexpr double kTick_s = 0.001;
constexpr double kPlannerStops_s = 5.005;  ///< after the first walking tick
/// Three seconds without plans. Both gaits are off by some milliseconds then. Where the encoder freezes
/// close to the instant from which the knee must move, its detection is off by up to 0.11 s. 8.0 and 8.1 s
/// are such instants; 7.7, 7.9 and 8.2 s are not.
constexpr double kFreezes_s = 7.9;
constexpr double kEnds_s = 9.0;

struct TwoProcessRun {
  std::vector<Change> changes;
  double gantry_released_s = 0.0;  ///< clock of robot and controller
};

TwoProcessRun run_two_processes(double duration_s, const std::vector<std::string>& controller,
                                const std::vector<std::string>& robot) {
  RobotAndController run;
  const std::string file = run.file("walk.mcap");
  Recorder recorder(run, file);
  EXPECT_TRUE(recorder.records()) << run.said();
  std::vector<std::string> robot_options = {"--lockstep", "--once"};
  robot_options.insert(robot_options.end(), robot.begin(), robot.end());
  run.start_robot(robot_options);
  std::vector<std::string> options = {"--lockstep",
                                      "--start",
                                      "walk@0.5",
                                      "--duration",
                                      std::to_string(duration_s),
                                      "--set",
                                      "discretisation.horizon_s=1"};
  options.insert(options.end(), controller.begin(), controller.end());
  run.start_controller(options);
  run.expect_both_to_end();
  EXPECT_EQ(recorder.end(), 0) << run.said();
  Changes changes;
  const replay::RecordContents contents = replay::read_contents(file);
  if (contents.runs.size() != 1) throw std::runtime_error("the record has no run\n" + run.said());
  replay::for_each_tick(file, contents.runs.front().number, [&](const TickRecord& tick) {
    changes.add(tick);
    return true;
  });
  return {changes.found, run.robot_json().at("gantry_released_s").get<double>()};
}

/// The readings of the emulated drivers: 16 bits over 6.4 rad, 12 bits over 40 rad/s, one tick old; and of
/// the torso sensor: 1e-6 rad, 5e-4 rad/s.
std::vector<Change> run_simulation(double walks_s) {
  testing_support::RunRequest request = testing_support::walking(0.5, 1.0, walks_s + kEnds_s);
  request.commands = {{0.0, {gait::GaitKind::stand, 0.0}}, {walks_s, {gait::GaitKind::walk, 0.5}}};
  request.plant = {"encoder_resolution_rad=9.766e-5", "encoder_velocity_resolution_rad_s=9.768e-3",
                   "base_pitch_resolution_rad=1e-6", "base_pitch_rate_resolution_rad_s=5e-4",
                   "reading_delay_s=0.001"};
  testing_support::SimulatedRun run(request);
  run.settings.planner_until_s = walks_s + kPlannerStops_s;
  run.settings.faults = {
      simulation::parse_fault("encoder-freeze:knee_L@" + std::to_string(walks_s + kFreezes_s))};
  Changes changes;
  run.settings.observer.ticked = [&](const TickRecord& tick) { changes.add(tick); };
  (void)run.run();
  return changes.found;
}

TEST(TwoProcesses, FaultsEndAWalkAtTheTickAtWhichTheyEndASimulatedOne) {
  const TwoProcessRun unhurt = run_two_processes(5.0, {}, {});
  ASSERT_FALSE(unhurt.changes.empty());
  const double walks_s = kTick_s * static_cast<double>(unhurt.changes.front().tick);
  const TwoProcessRun hurt =
      run_two_processes(walks_s + kEnds_s, {"--planner-until", std::to_string(walks_s + kPlannerStops_s)},
                        {"--fault", "encoder-freeze:knee_L@" +
                                        std::to_string(walks_s + kFreezes_s - unhurt.gantry_released_s)});
  const std::vector<Change> simulated = run_simulation(walks_s);
  EXPECT_EQ(hurt.changes, simulated);
  ASSERT_EQ(simulated.size(), 4u) << "plan, plan_feedback, gait, damp";
  EXPECT_EQ(simulated.back().state, supervisor::State::fault);
}

}  // namespace
}  // namespace stilt::two_processes
