#pragma once

#include "mpc_core/control/fall_catcher.h"
#include "mpc_core/control/parameters.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/control/speed_trim.h"
#include "mpc_core/gait/reference.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/sqp/sqp.h"
#include "mpc_core/sqp/terminal_cost.h"

namespace stilt::control {

/// Input of one plan.
struct PlannerInput {
  double time_s = 0.0;       ///< time of the state; must not decrease from call to call
  model::StateVector state;  ///< measured or estimated
  gait::GaitCommand command;
};

/// Result of configuring a planner.
enum class ConfigureStatus {
  ok,
  horizon_over_capacity,  ///< more intervals or contact switches than the memory holds
  terminal_cost_failed,   ///< the weights admit no stabilising solution of the Riccati equation
};

/// Robot and parameters in the form that a solve uses. 3 kB, owns nothing.
struct PlannerSettings {
  ControllerParameters parameters;
  ocp::ProblemData data;
};

/// Computes the settings. Takes milliseconds, not real-time safe. `settings` is complete only when the result
/// is ok.
[[nodiscard]] ConfigureStatus prepare_settings(const model::RobotModel& robot,
                                               const ControllerParameters& parameters,
                                               sqp::TerminalCostWorkspace& work,
                                               PlannerSettings& settings) noexcept;

/// The interface of the planner: measured state in, plan out. Keeps the contact schedule and the last
/// solution; the next solve starts from that solution, shifted in time. Fixed size, no heap. configure()
/// takes milliseconds and is not real-time safe; plan() is. Results depend on the inputs alone.
class Planner {
 public:
  [[nodiscard]] ConfigureStatus configure(const model::RobotModel& robot,
                                          const ControllerParameters& parameters) noexcept;

  /// Uses these settings from the next plan() on, and keeps the last solution. They must be for the same
  /// robot and horizon as before. Real-time safe.
  void adopt(const PlannerSettings& settings) noexcept;

  /// Steps follow the gaits of the library, instead of the heuristics, from the next plan() on. The library
  /// must outlive this object; its step time should be that of the gait parameters. Call after configure().
  /// Null: heuristics.
  void follow(const gait::GaitLibrary* library) noexcept { reference_.follow(*data_.robot, library); }

  /// Discards schedule and solution: the robot stands still from `time_s` on.
  void reset(double time_s) noexcept;

  /// Plans from the input's state. When a solve fails, the report says so and `plan` stays as it was: the
  /// caller keeps using the older plan.
  sqp::SolveReport plan(const PlannerInput& input, Plan& plan) noexcept;

  /// Clock for phase_times(). Null, the default: nothing is measured.
  void set_clock(sqp::ClockFunction clock) noexcept { sqp_.set_clock(clock); }
  [[nodiscard]] const sqp::PhaseTimes& phase_times() const noexcept { return sqp_.phase_times(); }

  /// Problem and data of the last solve, for tests and diagnostics.
  [[nodiscard]] const ocp::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const ocp::ProblemData& problem_data() const noexcept { return data_; }
  [[nodiscard]] const ocp::Trajectory& solution() const noexcept { return solution_[current_]; }

 private:
  [[nodiscard]] bool prepare(const PlannerInput& input) noexcept;
  void warm_start(const PlannerInput& input, ocp::Trajectory& guess) const noexcept;
  void guess_node(double time_s, int phase, bool is_end, double* x, double* u, int& hint) const noexcept;
  void write_plan(const PlannerInput& input, const sqp::SolveReport& report, Plan& plan) noexcept;

  ControllerParameters parameters_;
  ocp::ProblemData data_;
  gait::ContactSchedule schedule_;
  FallCatcher catcher_;
  SpeedTrim trim_;
  gait::HeuristicReference reference_;
  double speed_reference_m_s_ = 0.0;
  long long sequence_ = 0;

  sqp::TerminalCostWorkspace terminal_cost_work_;
  ocp::Problem problem_;
  sqp::Sqp sqp_;
  ocp::Trajectory solution_[2];  ///< the last usable solution, and the trial
  ocp::Horizon solved_horizon_;  ///< horizon of the last usable solution
  int current_ = 0;
  bool has_solution_ = false;
};

}  // namespace stilt::control
