#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/control_loop/control_loop.h"
#include "firmware/control_loop/mailboxes.h"
#include "firmware/control_loop/planner_task.h"
#include "host_tools/recording/replay/difference.h"
#include "host_tools/recording/replay/recorded_robot.h"

/// Replay of a recorded run. Control loop and planner of stiltd run tick by tick from the recorded inputs.
/// Their outputs are compared with the record bit for bit. Host only.
namespace stilt::replay {

/// Live tunables with a common number.
struct Tunings {
  control_loop::TorqueTuning torque;
  control_loop::PlannerTuning planner;
};

using TuningsByNumber = std::function<std::expected<Tunings, std::string>(std::uint32_t number)>;

/// Result of a replay.
struct Outcome {
  std::uint64_t ticks = 0;   ///< number of equal ticks
  std::uint64_t cycles = 0;  ///< number of equal solves of the planner
  std::optional<Difference> difference;
  std::string problem;  ///< missing data of the record, one sentence; empty: none

  [[nodiscard]] bool reproduced() const { return ticks > 0 && !difference && problem.empty(); }
};

/// Replay of one run.
class Replay {
 public:
  /// @param cycles   all solves of the run, in order
  /// @param tunings  live tunables by their number, or why they cannot be had: the end of a sentence that
  ///                 begins with them
  Replay(std::vector<control_loop::CycleRecord> cycles, TuningsByNumber tunings);

  /// Configure it as in the run before the first tick.
  [[nodiscard]] control_loop::ControlLoop& loop() { return *loop_; }
  [[nodiscard]] control_loop::PlannerTask& planner() { return *planner_; }

  /// Runs the next tick, and the planner's work on its state. False when something differs or is missing, see
  /// outcome(); the replay then stops.
  bool run(const control_loop::TickRecord& recorded);

  [[nodiscard]] const Outcome& outcome() const { return outcome_; }

 private:
  bool hand_in(const control_loop::TickRecord& recorded);
  bool hand_in_plan(const control_loop::TickRecord& recorded);
  bool run_cycle(const control_loop::CycleRecord& recorded);
  bool fail(const std::string& problem);
  bool differ(const Difference& difference);

  std::vector<control_loop::CycleRecord> cycles_;
  std::size_t next_cycle_ = 0;
  TuningsByNumber tunings_;
  RecordedRobot robot_;
  std::unique_ptr<control_loop::Mailboxes> mail_;
  std::unique_ptr<control_loop::ControlLoop> loop_;
  std::unique_ptr<control_loop::PlannerTask> planner_;
  std::map<long long, std::unique_ptr<control::Plan>> plans_;  ///< that can still become active
  std::uint64_t next_tick_ = 0;
  std::uint64_t solves_ = 0;
  long long visible_plan_ = -1;
  std::uint32_t torque_tuning_ = 0;
  bool ended_ = false;
  Outcome outcome_;
};

}  // namespace stilt::replay
