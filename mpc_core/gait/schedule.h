#pragma once

#include <array>

#include "mpc_core/gait/command.h"
#include "mpc_core/gait/parameters.h"
#include "mpc_core/model/types.h"

namespace stilt::gait {

/// An interval with one set of feet on the ground. It ends where the next one starts. The last phase of a
/// schedule that stands has no end.
struct ContactPhase {
  double start_s = 0.0;
  model::ContactMode mode;
  GaitKind gait = GaitKind::stand;
};

/// Time interval of one foot's contact or swing; ends may be infinite.
struct Interval {
  double start_s;
  double end_s;
};

/// Sequence of contact phases around the present. It has enough of the past for the lift-off points of the
/// swing feet. It has the present, and all phases up to the end of the horizon. Steps keep their time,
/// whatever the speed (docs/decisions/0030-steps-keep-their-time.md). Fixed memory, real-time safe.
///
/// Commands become active at contact boundaries. Stepping starts `switch_lead_s` after the command at the
/// earliest. A change between step and walk starts at the next step. Standing starts after the steps that the
/// deceleration needs, at most 20, and one to settle.
class ContactSchedule {
 public:
  static constexpr int kMaxPhases = 64;
  static constexpr double kNever_s = 1e9;  ///< end of a phase without end

  /// Stands on both feet from `time_s` on.
  void reset(double time_s) noexcept;

  /// Applies the command, drops old phases, and extends the schedule beyond `until_s`. `reference_speed_m_s`:
  /// the present speed reference, from which a stop decelerates. `left_ahead`: whether the left foot stands
  /// ahead of the right one. It decides with `fall` which foot steps first. Towards the commanded speed it is
  /// the leading foot, when falling the one that is farther from where the robot falls, at once. `tracked`:
  /// the present phase becomes this step, wherever the schedule was.
  void update(double time_s, double until_s, const GaitCommand& command, const GaitParameters& parameters,
              const ReferenceParameters& reference, double reference_speed_m_s, bool left_ahead,
              Fall fall = Fall::none, const TrackedStep& tracked = {}) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const ContactPhase& phase(int index) const noexcept { return phases_[index]; }
  [[nodiscard]] double end_s(int index) const noexcept {
    return index + 1 < count_ ? phases_[index + 1].start_s : kNever_s;
  }
  /// Index of the phase that is active at a time; a boundary belongs to the later phase.
  [[nodiscard]] int index_at(double time_s) const noexcept;

  /// The interval around phase `index` in which the foot keeps its state (contact or swing) of that phase.
  [[nodiscard]] Interval foot_interval(int index, int foot) const noexcept;

 private:
  void append(double start_s, model::ContactMode mode, GaitKind gait) noexcept;
  void keep_step(double time_s, const TrackedStep& tracked) noexcept;
  void append_next(double earliest_start_s, const GaitParameters& parameters, bool lift_left) noexcept;
  [[nodiscard]] bool about_to_land(double time_s, const GaitParameters& parameters) const noexcept;
  void drop_past(double time_s) noexcept;

  std::array<ContactPhase, kMaxPhases> phases_{};
  int count_ = 0;
  GaitCommand command_{};
  int steps_before_stand_ = 0;  ///< steps still to append before standing
};

}  // namespace stilt::gait
