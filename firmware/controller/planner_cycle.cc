#include "firmware/controller/planner_cycle.h"

namespace stilt::controller {

bool PlannerCycle::cycle(const PlanningRequest& request, control::Plan& plan) noexcept {
  if (request.session != result_.session) {
    planner_.reset(request.time_s);
    result_.failures_in_a_row = 0;
    result_.session = request.session;
  }
  if (request.session == 0) return false;
  report_ = planner_.plan({request.time_s, request.state, request.command}, plan);
  ++result_.cycles;
  result_.status = report_.status;
  result_.failures_in_a_row = report_.usable() ? 0 : result_.failures_in_a_row + 1;
  return report_.usable();
}

}  // namespace stilt::controller
