#pragma once

#include <cstdint>
#include <optional>

#include "firmware/control_loop/planner_task.h"
#include "hal/robot/clock.h"

namespace stilt::control_loop {

/// When plans are made and become active on a virtual clock, in ticks of the torque loop. Nothing depends on
/// the wall clock.
struct PlanTiming {
  std::int64_t tick_ns;
  long long period_ticks;
  long long delay_ticks;

  /// Rounded to whole ticks, the delay to at least one: a plan becomes active at a tick after the one it
  /// starts from. A new plan starts only when the last one has become active.
  explicit PlanTiming(const control::TimingParameters& timing) noexcept;
};

/// The planner's turns between the ticks of the control loop, in lock-step and in simulations. Fixed memory.
class PlannerSchedule {
 public:
  explicit PlannerSchedule(const control::TimingParameters& timing) noexcept : timing_(timing) {}

  [[nodiscard]] const PlanTiming& timing() const noexcept { return timing_; }

  /// Before the first tick: plans from the newest request at once; the plan is active in the first tick.
  /// @return  duration of the solve by the clock, ns
  [[nodiscard]] std::int64_t begin(PlannerTask& planner, Mailboxes& mail, hal::Clock& clock) noexcept;

  /// Before the tick: a plan that is due becomes active.
  void publish_due(long long tick, const PlannerTask& planner, Mailboxes& mail) noexcept;

  /// After the tick: plans from its state when it is time to.
  /// @return  duration of the solve by the clock, ns; nothing when it is not time to
  [[nodiscard]] std::optional<std::int64_t> plan(long long tick, PlannerTask& planner, Mailboxes& mail,
                                                 hal::Clock& clock) noexcept;

 private:
  [[nodiscard]] std::int64_t solve(const PlanningRequest& request, PlannerTask& planner, Mailboxes& mail,
                                   hal::Clock& clock) noexcept;

  PlanTiming timing_;
  std::uint32_t episode_ = 0;
  std::int64_t planned_tick_ = -1;  ///< of the newest plan's state
  long long due_ = -1;              ///< tick at which it becomes active
  bool fresh_ = false;
};

}  // namespace stilt::control_loop
