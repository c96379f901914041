#include "host_tools/gait_synthesis/synthesize.h"

#include <cmath>
#include <cstdio>

#include "host_tools/gait_synthesis/gait_check.h"
#include "host_tools/gait_synthesis/gait_metrics.h"
#include "host_tools/gait_synthesis/initial_guess.h"
#include "host_tools/gait_synthesis/motion_fit.h"

namespace stilt::gait_synthesis {
namespace {

struct NamedCost {
  CostKind cost;
  const char* name;
  const char* meaning;
};
constexpr NamedCost kCosts[] = {
    {CostKind::torque_squared, "torque", "sum of squared joint torques (1e-3 Nm^2) over time, per metre"},
    {CostKind::mechanical_power, "power",
     "sum of |torque x joint speed| (1e-2 W) and squared torque (3e-4 Nm^2) over time, per metre"},
    {CostKind::acceleration_squared, "acceleration",
     "sum of squared joint accelerations (1e-3 rad^2/s^4) over time, per metre"},
};

std::string short_text(double value) {
  char text[40];
  (void)std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

NoGait no_gait(const StepTask& task, const std::string& reason) {
  return NoGait("no gait at " + short_text(task.speed_m_s) + " m/s: " + reason +
                "; try another step time or wider limits");
}

}  // namespace

std::optional<CostKind> cost_of_name(std::string_view name) {
  for (const NamedCost& row : kCosts) {
    if (row.name == name) return row.cost;
  }
  return std::nullopt;
}

gait::PhaseKind phase_for_speed(double speed_m_s) {
  return std::abs(speed_m_s) < kSlowestByHip_m_s ? gait::PhaseKind::time : gait::PhaseKind::hip_position;
}

namespace {

/// The gait of a task on its own grid.
Synthesis on_grid(const model::RobotModel& robot, const StepTask& task) {
  const StepProgram program(robot, task);
  const Eigen::VectorXd start = initial_guess(robot.constants, task, program);
  const nonlinear_program::IpoptSolution solution = nonlinear_program::solve(program, start, {});
  if (!solution.solved) throw no_gait(task, solution.status);
  Synthesis result;
  result.gait.step_time_s = task.step_time_s;
  result.gait.step_length_m = task.step_length_m();
  result.gait.outputs = program.outputs(solution.v);
  try {
    fit_motion(robot, program.start_state(solution.v), result.gait);
  } catch (const std::runtime_error& error) {
    throw no_gait(task, error.what());
  }
  if (!place_feet(robot, result.gait)) throw no_gait(task, "a slightly disturbed step falls");
  result.gait.speed_m_s = task.speed_m_s;
  const double length_m = std::abs(task.step_length_m());
  result.cost_per_m = solution.cost * task.step_time_s / (length_m > 0.0 ? length_m : 1.0);
  result.iterations = solution.iterations;
  result.elements = task.elements;
  result.solution = solution.v;
  return result;
}

/// Whether the optimum is the motion of the hybrid model only roughly: its outputs are not hybrid invariant,
/// or its speed is another one. A finer grid mends that. It does not make a motion smooth that polynomials of
/// kMotionDegree follow roughly.
bool too_coarse(const model::RobotModel& robot, const StepTask& task, const gait::HzdGait& gait) {
  const CheckTolerances tolerances;
  const gait_files::GaitMetrics metrics = gait_metrics(robot, gait);
  const bool smooth =
      metrics.defect_max <= tolerances.defect && metrics.periodicity_error <= tolerances.periodicity;
  const double speed_error_m_s = std::abs(gait.step_length_m / gait.step_time_s - task.speed_m_s);
  return smooth &&
         (metrics.output_error_max_rad > tolerances.output_rad || speed_error_m_s > tolerances.speed_m_s);
}

}  // namespace

Synthesis synthesize(const model::RobotModel& robot, const StepTask& task) {
  constexpr int kDoublings = 2;
  Synthesis result = on_grid(robot, task);
  StepTask finer = task;
  for (int i = 0; i < kDoublings && too_coarse(robot, task, result.gait); ++i) {
    finer.elements *= 2;
    try {
      result = on_grid(robot, finer);
    } catch (const NoGait&) {
      break;  // the check of the coarser one names what it lacks
    }
  }
  return result;
}

gait_files::GaitRecord make_record(const model::RobotModel& robot, const StepTask& task,
                                   const Synthesis& synthesis) {
  gait_files::GaitRecord record;
  record.robot = robot.constants.name;
  record.gait = synthesis.gait;
  record.limits = task.limits;
  record.claims = gait_metrics(robot, record.gait);
  const char* meaning = "";
  for (const NamedCost& row : kCosts) meaning = row.cost == task.cost ? row.meaning : meaning;
  record.origin = {
      // in alphabetical order, in which they are read back
      {"asked", short_text(task.speed_m_s) + " m/s, step time " + short_text(task.step_time_s) + " s"},
      {"cost", short_text(synthesis.cost_per_m) + ": " + meaning},
      {"method", "direct collocation (Lobatto IIIA, " + std::to_string(synthesis.elements) +
                     " elements of degree " + std::to_string(task.element_degree) + "), solved by Ipopt in " +
                     std::to_string(synthesis.iterations) +
                     " iterations; then the periodic motion of the hybrid model under these outputs"},
      {"program", "stilt gait synthesize"},
  };
  return record;
}

}  // namespace stilt::gait_synthesis
