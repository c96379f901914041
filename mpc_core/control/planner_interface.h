#pragma once

#include "mpc_core/control/plan.h"
#include "mpc_core/control/planner_settings.h"
#include "mpc_core/gait/gait_library.h"
#include "mpc_core/ocp/clock.h"

namespace stilt::control {

/// Measured state in, plan out. Keeps the contact schedule and the last solution; the next solve starts from
/// that solution, shifted in time. No type that passes through here has a layout that depends on the
/// instruction set: implementations for several are linked into one program (mpc_core/dispatch). Results
/// depend on the inputs and the instruction set alone.
class PlannerInterface {
 public:
  /// Takes milliseconds, not real-time safe.
  [[nodiscard]] virtual ConfigureStatus configure(const model::RobotModel& robot,
                                                  const ControllerParameters& parameters) noexcept = 0;

  /// Uses these settings from the next plan() on, and keeps the last solution. They must be for the same
  /// robot and horizon as before. Real-time safe.
  virtual void adopt(const PlannerSettings& settings) noexcept = 0;

  /// Steps follow the gaits of the library, instead of the heuristics, from the next plan() on. The library
  /// must outlive this object; its step time should be that of the gait parameters. Call after configure().
  /// Null: heuristics.
  virtual void follow(const gait::GaitLibrary* library) noexcept = 0;

  /// Discards schedule and solution: the robot stands still from `time_s` on. Real-time safe.
  virtual void reset(double time_s) noexcept = 0;

  /// Plans from the input's state. When a solve fails, the report says so and `plan` stays as it was: the
  /// caller keeps using the plan before. Real-time safe.
  virtual sqp::SolveReport plan(const PlannerInput& input, Plan& plan) noexcept = 0;

  /// Clock for phase_times(). Null, the default: nothing is measured.
  virtual void set_clock(ocp::ClockFunction clock) noexcept = 0;
  [[nodiscard]] virtual const sqp::PhaseTimes& phase_times() const noexcept = 0;

 protected:
  PlannerInterface() = default;
  PlannerInterface(const PlannerInterface&) = default;
  PlannerInterface& operator=(const PlannerInterface&) = default;
  ~PlannerInterface() = default;
};

}  // namespace stilt::control
