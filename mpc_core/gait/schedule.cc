#include "mpc_core/gait/schedule.h"

#include <algorithm>
#include <cmath>

namespace stilt::gait {
namespace {

constexpr model::ContactMode kBoth{true, true};

bool is_single(const model::ContactMode& mode) noexcept { return mode.count() == 1; }

model::ContactMode other(const model::ContactMode& mode) noexcept { return {mode.right, mode.left}; }

/// Number of steps that a stop needs: those of the deceleration, and one to settle.
int steps_to_stop(double speed_m_s, const GaitParameters& gait,
                  const ReferenceParameters& reference) noexcept {
  const double step_s = gait.single_support_s + gait.double_support_s;
  const double deceleration_s = std::abs(speed_m_s) / reference.speed_ramp_m_s2;
  return 1 + static_cast<int>(std::ceil(std::min(deceleration_s / step_s, 20.0)));
}

}  // namespace

void ContactSchedule::reset(double time_s) noexcept {
  count_ = 0;
  command_ = GaitCommand{};
  steps_before_stand_ = 0;
  append(time_s, kBoth, GaitKind::stand);
}

void ContactSchedule::append(double start_s, model::ContactMode mode, GaitKind gait) noexcept {
  if (count_ < kMaxPhases) phases_[count_++] = {start_s, mode, gait};
}

int ContactSchedule::index_at(double time_s) const noexcept {
  int index = 0;
  while (index + 1 < count_ && phases_[index + 1].start_s <= time_s) ++index;
  return index;
}

Interval ContactSchedule::foot_interval(int index, int foot) const noexcept {
  const bool contact = phases_[index].mode[foot];
  int first = index;
  while (first > 0 && phases_[first - 1].mode[foot] == contact) --first;
  int last = index;
  while (last + 1 < count_ && phases_[last + 1].mode[foot] == contact) ++last;
  return {phases_[first].start_s, end_s(last)};
}

/// Whether the present swing is too old to move its foothold, or has landed already. The last foot but one to
/// land before a stand is placed to make room between the feet.
bool ContactSchedule::about_to_land(double time_s, const GaitParameters& parameters) const noexcept {
  constexpr double kPlaceable = 0.5;
  const ContactPhase& present = phases_[count_ - 1];
  const double elapsed_s = time_s - present.start_s;
  if (present.mode == kBoth) return present.gait != GaitKind::stand;
  return elapsed_s > (1.0 - kPlaceable) * parameters.single_support_s;
}

void ContactSchedule::drop_past(double time_s) noexcept {
  constexpr int kKeptPast = 6;  // covers the contact before the current swing, with double support
  const int drop = index_at(time_s) - kKeptPast;
  if (drop <= 0) return;
  std::move(phases_.begin() + drop, phases_.begin() + count_, phases_.begin());
  count_ -= drop;
}

void ContactSchedule::append_next(double earliest_start_s, const GaitParameters& parameters,
                                  bool lift_left) noexcept {
  const ContactPhase& last = phases_[count_ - 1];
  if (last.gait == GaitKind::stand) {
    append(earliest_start_s, {!lift_left, lift_left}, command_.kind);
    return;
  }
  const bool stopping = command_.kind == GaitKind::stand;
  const GaitKind kind = stopping ? GaitKind::step : command_.kind;
  if (is_single(last.mode)) {
    const double start_s = last.start_s + parameters.single_support_s;
    if (stopping && steps_before_stand_ <= 0) {
      append(start_s, kBoth, GaitKind::stand);
    } else if (parameters.double_support_s > 0.0) {
      append(start_s, kBoth, kind);
    } else {
      append(start_s, other(last.mode), kind);
      --steps_before_stand_;
    }
    return;
  }
  append(last.start_s + parameters.double_support_s, other(phases_[count_ - 2].mode), kind);
  --steps_before_stand_;
}

/// The step ends when the gait's does; one that lasts longer ends in 10 ms.
void ContactSchedule::keep_step(double time_s, const TrackedStep& tracked) noexcept {
  constexpr double kSoon_s = 0.01;
  const model::ContactMode mode{tracked.stance_foot == model::kLeft, tracked.stance_foot == model::kRight};
  const GaitKind kind = command_.kind == GaitKind::stand ? GaitKind::step : command_.kind;
  while (count_ > 0 &&
         (phases_[count_ - 1].start_s >= tracked.touch_down_s || phases_[count_ - 1].mode == mode)) {
    --count_;
  }
  append(tracked.touch_down_s, mode, kind);
  append(std::max(tracked.touch_down_s + tracked.duration_s, time_s + kSoon_s), other(mode), kind);
  --steps_before_stand_;
}

void ContactSchedule::update(double time_s, double until_s, const GaitCommand& command,
                             const GaitParameters& parameters, const ReferenceParameters& reference,
                             double reference_speed_m_s, bool left_ahead, Fall fall,
                             const TrackedStep& tracked) noexcept {
  drop_past(time_s);
  const bool is_tracked = tracked.stance_foot >= 0;
  if (is_tracked || command.kind != command_.kind) {
    count_ = index_at(time_s) + 1;  // keeps the present phase, schedules the future anew
    steps_before_stand_ = steps_to_stop(reference_speed_m_s, parameters, reference);
    if (about_to_land(time_s, parameters)) ++steps_before_stand_;
  }
  command_ = command;
  if (is_tracked) keep_step(time_s, tracked);
  // When walking forward the leading foot steps first: the robot then falls forward.
  const bool forward = fall == Fall::none ? command_.speed_m_s >= 0.0 : fall == Fall::backward;
  const bool lift_left = forward == left_ahead;
  const double lead_s = fall == Fall::none ? parameters.switch_lead_s : parameters.catch_lead_s;
  while (count_ < kMaxPhases) {
    const ContactPhase& last = phases_[count_ - 1];
    if (last.gait == GaitKind::stand && command_.kind == GaitKind::stand) break;
    if (last.start_s > until_s) break;
    append_next(std::max(time_s, last.start_s) + lead_s, parameters, lift_left);
  }
}

}  // namespace stilt::gait
