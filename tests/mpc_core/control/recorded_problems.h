#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpc_core/gait/reference.h"
#include "mpc_core/ocp/problem.h"
#include "mpc_core/sqp/sqp.h"

/// Planning problems with their optimum, kept in tests/data/recorded_problems.txt: whatever is done to the
/// solver for speed, it has to find these optima again. The active weights and limits are those of
/// recorded_problems.cc, not the shipped ones, so that tuning does not touch them.
namespace stilt::testing_support {

/// Everything that defines one planning problem besides the fixed weights. The robot stands at time 0, is
/// then given the command, and plans at `time_s`.
struct PlanningQuestion {
  std::string robot = "amber3m";
  gait::GaitCommand command;
  double stop_time_s = -1.0;  ///< the command is replaced by `stand` then; negative: never
  double time_s = 0.0;
  double horizon_s = 1.0;
  double double_support_s = 0.0;
  double speed_reference_m_s = 0.0;  ///< active at time_s
  double speed_trim_m_s = 0.0;
  ocp::Integrator integrator = ocp::Integrator::rk2;
  ocp::Transition transition = ocp::Transition::impact;
  model::StateVector state = model::StateVector::Zero();  ///< at time_s
};

/// One node of the optimum; the input is that of the stage starting there (of the last stage for the last
/// node).
struct OptimalNode {
  int node = 0;
  model::StateVector state;
  model::InputVector input;
};

/// The optimum, with a few nodes of its trajectory.
struct RecordedOptimum {
  double cost = 0.0;
  int stages = 0;
  std::vector<OptimalNode> nodes;
};

struct RecordedProblem {
  PlanningQuestion question;
  RecordedOptimum optimum;
};

/// A question laid out for the solver, with the planner's initial guess. The guess is the initial state
/// everywhere, moving along with the reference in x, under the reference's inputs.
struct PreparedProblem {
  ocp::ProblemData data;
  ocp::Problem problem;
  ocp::Trajectory guess;
};

/// Throws std::invalid_argument when the question has no such robot or its horizon does not fit.
[[nodiscard]] std::unique_ptr<PreparedProblem> prepare(const PlanningQuestion& question);

/// How far a hard solve got.
struct HardSolve {
  bool usable = false;
  double cost = 0.0;
  double last_step = 0.0;  ///< largest component of the last step: m, rad, m/s, rad/s, rad/s^2, N
  double violation = 0.0;  ///< larger of the dynamics' defect and the equalities' violation
  int iterations = 0;
};

/// Solves until rounding stops the progress. There are at most `kSearchIterations` with line search until the
/// step is below `kSearchStep`. Then there are at most `kPolishIterations` full steps until the step is below
/// `kPolishStep`. (The line search compares costs, whose rounding hides steps below the root of the
/// precision.)
[[nodiscard]] HardSolve solve_hard(const PreparedProblem& prepared, sqp::Sqp& sqp, ocp::Trajectory& iterate);

inline constexpr int kSearchIterations = 60;
inline constexpr double kSearchStep = 1e-5;
inline constexpr int kPolishIterations = 40;
inline constexpr double kPolishStep = 1e-9;

/// Cost and five nodes, evenly spread, of a solution.
[[nodiscard]] RecordedOptimum sampled(const PreparedProblem& prepared, const ocp::Trajectory& solution,
                                      double cost);

/// Largest difference of the sampled states and inputs. Each is relative to the larger of 1 and the largest
/// magnitude of its kind of quantity over the nodes: positions, velocities, joint accelerations, forces.
[[nodiscard]] double distance(const RecordedOptimum& a, const RecordedOptimum& b);

/// One problem per line, as the heading of the file explains. Reading throws std::runtime_error naming the
/// line.
void write_problems(const std::vector<RecordedProblem>& problems, const std::string& path);
[[nodiscard]] std::vector<RecordedProblem> read_problems(const std::string& path);

}  // namespace stilt::testing_support
