#include "firmware/control_loop/planner_schedule.h"

#include <algorithm>
#include <cmath>

namespace stilt::control_loop {

PlanTiming::PlanTiming(const control::TimingParameters& timing) noexcept
    : tick_ns(std::llround(1e9 / timing.torque_rate_hz)),
      delay_ticks(std::max(1LL, std::llround(timing.plan_delay_s * timing.torque_rate_hz))) {
  period_ticks = std::max(delay_ticks, std::llround(timing.torque_rate_hz / timing.plan_rate_hz));
}

std::int64_t PlannerSchedule::solve(const PlanningRequest& request, PlannerTask& planner, Mailboxes& mail,
                                    hal::Clock& clock) noexcept {
  planned_tick_ = request.tick;
  const std::int64_t start_ns = clock.now_ns();
  fresh_ = planner.plan(request, mail);
  const std::int64_t duration_ns = clock.now_ns() - start_ns;
  planner.record(request, fresh_, 0, mail);
  return duration_ns;
}

std::int64_t PlannerSchedule::begin(PlannerTask& planner, Mailboxes& mail, hal::Clock& clock) noexcept {
  const PlanningRequest& request = mail.requests.newest();
  episode_ = request.stance_episode;
  due_ = request.tick;
  return solve(request, planner, mail, clock);
}

void PlannerSchedule::publish_due(long long tick, const PlannerTask& planner, Mailboxes& mail) noexcept {
  if (tick != due_) return;
  if (fresh_) mail.plans.publish();
  mail.results.writer() = planner.result();
  mail.results.publish();
}

std::optional<std::int64_t> PlannerSchedule::plan(long long tick, PlannerTask& planner, Mailboxes& mail,
                                                  hal::Clock& clock) noexcept {
  const PlanningRequest& request = mail.requests.newest();
  const bool begins = request.stance_episode != episode_;
  episode_ = request.stance_episode;
  if (episode_ == 0 || tick < due_ || request.tick == planned_tick_) return std::nullopt;
  if (!begins && tick % timing_.period_ticks != 0) return std::nullopt;
  due_ = tick + timing_.delay_ticks;
  return solve(request, planner, mail, clock);
}

}  // namespace stilt::control_loop
