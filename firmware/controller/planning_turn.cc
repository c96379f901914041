#include "firmware/controller/planning_turn.h"

#include "firmware/controller/plan_checksum.h"

namespace stilt::controller {

void PlanningTurn::tell(const PlannerCycle& planner, const PlanningRequest& request, bool fresh,
                        std::int64_t solve_ns, Mailboxes& mail) noexcept {
  const control::Plan& plan = mail.plans.writer();
  const PlanningResult& result = planner.result();
  if (CycleRecord* record = mail.cycles.claim()) {
    record->cycle = result.cycles;
    record->tick = request.tick;
    record->time_s = request.time_s;
    record->standing = request.session;
    record->plan_sequence = fresh ? plan.sequence : -1;
    record->failures = result.failures_in_a_row;
    record->tuning = planner.tuning();
    record->nodes = fresh ? plan.nodes : 0;
    record->checksum = fresh ? plan_checksum(plan) : 0;
    record->solve_ns = solve_ns;
    record->report = planner.report();
    mail.cycles.commit();
  }
  constexpr double kRounding_s = 1e-9;
  const double since_s = request.time_s - sketched_s_;
  if (!fresh || (since_s >= 0.0 && since_s < 1.0 / kSketchRate_hz - kRounding_s)) return;
  sketched_s_ = request.time_s;
  sketch_plan(plan, kSketchSpacing_s, mail.sketches.writer());
  mail.sketches.publish();
}

}  // namespace stilt::controller
