#pragma once

#include "mpc_core/control/fall_catcher.h"
#include "mpc_core/control/planner_interface.h"
#include "mpc_core/control/speed_trim.h"
#include "mpc_core/gait/reference.h"
#include "mpc_core/sqp/sqp.h"

namespace stilt::control {

/// The planner for the instruction set that this source is compiled for. Fixed size, no heap.
class Planner final : public PlannerInterface {
 public:
  [[nodiscard]] ConfigureStatus configure(const model::RobotModel& robot,
                                          const ControllerParameters& parameters) noexcept override;
  void adopt(const PlannerSettings& settings) noexcept override;
  void follow(const gait::GaitLibrary* library) noexcept override {
    reference_.follow(*data_.robot, library);
  }
  void reset(double time_s) noexcept override;
  sqp::SolveReport plan(const PlannerInput& input, Plan& plan) noexcept override;
  void set_clock(ocp::ClockFunction clock) noexcept override { sqp_.set_clock(clock); }
  [[nodiscard]] const sqp::PhaseTimes& phase_times() const noexcept override { return sqp_.phase_times(); }

  /// Problem and data of the last solve, for tests and diagnostics.
  [[nodiscard]] const ocp::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const ocp::ProblemData& problem_data() const noexcept { return data_; }
  [[nodiscard]] const ocp::Trajectory& solution() const noexcept { return solution_[current_]; }

 private:
  [[nodiscard]] bool prepare(const PlannerInput& input) noexcept;
  /// Starts the plan after an inelastic contact of the stance foot. The measured velocities move it a little,
  /// those of the plan do not (docs/decisions/0036-five-hundred-plans-per-second.md).
  void bring_stance_foot_to_rest() noexcept;
  void warm_start(ocp::Trajectory& guess) const noexcept;
  void guess_node(double time_s, int phase, bool before_switch, double* x, double* u,
                  int& hint) const noexcept;
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
