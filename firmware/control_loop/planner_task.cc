#include "firmware/control_loop/planner_task.h"

#include "firmware/control_loop/plan_checksum.h"
#include "firmware/control_loop/trace_points.h"

namespace stilt::control_loop {

bool PlannerTask::cycle(const PlanningRequest& request, control::Plan& plan) noexcept {
  if (request.stance_episode != result_.stance_episode) {
    planner_.planner().reset(request.time_s);
    result_.failures_in_a_row = 0;
    result_.stance_episode = request.stance_episode;
  }
  if (request.stance_episode == 0) return false;
  trace::solve_begin(request.tick, static_cast<int>(request.command.kind));
  report_ = planner_.planner().plan({request.time_s, request.state, request.command, request.tracked}, plan);
  trace::solve_end(request.tick, static_cast<int>(report_.status), report_.iterations);
  ++result_.cycles;
  result_.status = report_.status;
  result_.failures_in_a_row = report_.usable() ? 0 : result_.failures_in_a_row + 1;
  return report_.usable();
}

void PlannerTask::record(const PlanningRequest& request, bool fresh, std::int64_t solve_ns,
                         Mailboxes& mail) noexcept {
  const control::Plan& plan = mail.plans.writer();
  if (CycleRecord* record = mail.cycles.claim()) {
    record->cycle = result_.cycles;
    record->tick = request.tick;
    record->time_s = request.time_s;
    record->stance_episode = request.stance_episode;
    record->plan_sequence = fresh ? plan.sequence : -1;
    record->failures = result_.failures_in_a_row;
    record->tuning = tuning_;
    record->nodes = fresh ? plan.nodes : 0;
    record->checksum = fresh ? plan_checksum(plan) : 0;
    record->solve_ns = solve_ns;
    record->report = report_;
    mail.cycles.commit();
  }
  constexpr double kRounding_s = 1e-9;
  const double since_s = request.time_s - previewed_s_;
  if (!fresh || (since_s >= 0.0 && since_s < 1.0 / kPreviewRate_hz - kRounding_s)) return;
  previewed_s_ = request.time_s;
  preview_plan(plan, kPreviewSpacing_s, mail.previews.writer());
  mail.previews.publish();
}

}  // namespace stilt::control_loop
