#pragma once

#include <cstdint>

#include "firmware/controller/mailboxes.h"
#include "firmware/controller/planner_cycle.h"

namespace stilt::controller {

/// The planner at the mailboxes: takes new tunables, plans from the newest request, and tells telemetry about
/// it. On the clock and in lock-step alike. Fixed memory, real-time.
class PlanningTurn {
 public:
  /// Sketches of plans for drawing, at most so many a second.
  static constexpr double kSketchRate_hz = 30.0;
  static constexpr double kSketchSpacing_s = 0.03;

  /// Plans into mail.plans.writer(), which the caller publishes when it is time to; see
  /// PlannerCycle::cycle().
  [[nodiscard]] bool plan(PlannerCycle& planner, const PlanningRequest& request, Mailboxes& mail) noexcept {
    if (mail.planner_tunings.has_news()) planner.tune(mail.planner_tunings.newest());
    return planner.cycle(request, mail.plans.writer());
  }

  /// After plan() of a request that wants one, before the plan is published.
  /// @param fresh     what plan() gave
  /// @param solve_ns  duration; 0 in lock-step
  void tell(const PlannerCycle& planner, const PlanningRequest& request, bool fresh, std::int64_t solve_ns,
            Mailboxes& mail) noexcept;

 private:
  double sketched_s_ = -1.0;  ///< start of the newest sketch
};

}  // namespace stilt::controller
