// clang-format off
// Writes tests/data/recorded_problems.txt. Not run by the tests: it defines the optima that later solvers
// have to find.
//
// Candidates are seeded 1, 2, ...: robot, gait, speed, horizon and discretisation are drawn. A planner then
// walks the robot exactly along its plans to a random time, pushed on the way (jumps of the base's
// velocity). The state that it reaches is disturbed. A candidate is left out when
//   - the walk or the solve fails,
//   - the last of 40 full Gauss-Newton steps after 60 with line search still exceeds 1e-9 (any unit),
//   - one of three other initial guesses leads to another optimum (relative cost 1e-9, trajectory 1e-8).
// With --again the questions of the file stay, and those of another optimum get it. Use it for a change of
// cost, constraints or reference that concerns some of them.
// clang-format on
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_law.h"
#include "tests/mpc_core/control/recorded_problems.h"
#include "tests/robots.h"

namespace stilt::testing_support {
namespace {

constexpr std::size_t kProblems = 200;
constexpr double kPeriod_s = 0.02;
constexpr double kSameCost = 1e-9;
constexpr double kSameTrajectory = 1e-8;

using Random = std::mt19937_64;

double uniform(Random& random, double from, double to) {
  return from + (to - from) * static_cast<double>(random() >> 11) * 0x1p-53;
}

double normal(Random& random) {  // sum of twelve: the same on every standard library
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += uniform(random, 0.0, 1.0);
  return sum;
}

template <std::size_t N>
double one_of(Random& random, const double (&values)[N]) {
  return values[random() % N];
}

PlanningQuestion drawn_question(Random& random) {
  PlanningQuestion q;
  q.robot = uniform(random, 0.0, 1.0) < 0.8 ? "amber3m" : "rabbit";
  const double kind = uniform(random, 0.0, 1.0);
  q.command.kind = kind < 0.15  ? gait::GaitKind::stand
                   : kind < 0.4 ? gait::GaitKind::step
                                : gait::GaitKind::walk;
  if (q.command.kind == gait::GaitKind::walk) q.command.speed_m_s = uniform(random, -0.4, 1.0);
  q.time_s = kPeriod_s * std::floor(uniform(random, 0.0, 150.0));
  q.horizon_s = one_of(random, {0.2, 0.3, 0.5, 0.5, 0.7, 1.0, 1.0, 1.5, 2.0});
  q.double_support_s = one_of(random, {0.0, 0.0, 0.0, 0.05, 0.1});
  if (uniform(random, 0.0, 1.0) < 0.1) q.stop_time_s = q.time_s - uniform(random, 0.0, 0.4);
  q.integrator = uniform(random, 0.0, 1.0) < 0.85 ? ocp::Integrator::rk2 : ocp::Integrator::rk4;
  q.transition = uniform(random, 0.0, 1.0) < 0.85 ? ocp::Transition::impact : ocp::Transition::identity;
  q.speed_trim_m_s = q.command.kind == gait::GaitKind::stand ? 0.0 : uniform(random, -0.15, 0.15);
  return q;
}

control::ControllerParameters planner_parameters(const PlanningQuestion& q) {
  control::ControllerParameters parameters;
  if (q.robot == "rabbit") {
    parameters.gait.single_support_s = 0.4;
    parameters.reference.base_height_m = 0.735;
  }
  parameters.gait.double_support_s = q.double_support_s;
  parameters.discretisation.integrator = q.integrator;
  parameters.discretisation.transition = q.transition;
  return parameters;
}

/// Walks to the question's time and sets its state and speed reference. False when a plan failed.
bool walk_there(Random& random, PlanningQuestion& q) {
  const model::RobotModel& robot = *testing_support::find_robot(q.robot);
  const control::ControllerParameters parameters = planner_parameters(q);
  const auto planner = std::make_unique<control::Planner>();
  const auto plan = std::make_unique<control::Plan>();
  if (planner->configure(robot, parameters) != control::ConfigureStatus::ok) return false;
  planner->reset(0.0);
  q.state = gait::standing_state(robot.constants, parameters.reference.base_height_m, 0.0,
                                 parameters.gait.stand_half_width_m, true);
  const int cycles = static_cast<int>(std::lround(q.time_s / kPeriod_s));
  for (int i = 0; i < cycles; ++i) {
    const bool stopped = q.stop_time_s >= 0.0 && kPeriod_s * i >= q.stop_time_s;
    const gait::GaitCommand command = stopped ? gait::GaitCommand{} : q.command;
    if (!planner->plan({kPeriod_s * i, q.state, command}, *plan).usable()) return false;
    q.state = control::interpolate(*plan, kPeriod_s * (i + 1)).state;
    if (random() % 50 == 0) q.state[model::kPositions] += 0.25 * normal(random);
  }
  const double ramped_m_s = parameters.reference.speed_ramp_m_s2 * std::max(0.0, q.time_s - 0.3);
  q.speed_reference_m_s =
      std::copysign(std::min(std::abs(q.command.speed_m_s), ramped_m_s), q.command.speed_m_s);
  return true;
}

void disturb(Random& random, PlanningQuestion& q) {
  const double size = one_of(random, {0.0, 0.3, 1.0, 1.0, 2.0});
  for (int i = 1; i < model::kPositions; ++i) q.state[i] += size * 0.02 * normal(random);
  for (int i = model::kPositions; i < model::kStates; ++i) q.state[i] += size * 0.2 * normal(random);
}

/// Noise on the guess, growing with its number.
void disturb_guess(int number, Random& random, const ocp::Horizon& horizon, ocp::Trajectory& guess) {
  for (int k = 1; k <= horizon.stages; ++k) {
    for (int i = 0; i < model::kStates; ++i) guess.x[k][i] += 0.03 * number * normal(random);
  }
}

bool answer(Random& random, RecordedProblem& problem, sqp::Sqp& sqp) {
  const auto prepared = prepare(problem.question);
  const auto iterate = std::make_unique<ocp::Trajectory>(prepared->guess);
  const HardSolve solve = solve_hard(*prepared, sqp, *iterate);
  if (!solve.usable || !(solve.last_step < kPolishStep)) return false;
  problem.optimum = sampled(*prepared, *iterate, solve.cost);
  for (int number = 1; number <= 3; ++number) {
    *iterate = prepared->guess;
    disturb_guess(number, random, prepared->problem.horizon, *iterate);
    const HardSolve other = solve_hard(*prepared, sqp, *iterate);
    const double cost_change = std::abs(other.cost - solve.cost) / std::abs(solve.cost);
    const RecordedOptimum optimum = sampled(*prepared, *iterate, other.cost);
    if (!other.usable || !(cost_change < kSameCost)) return false;
    if (!(distance(optimum, problem.optimum) < kSameTrajectory)) return false;
  }
  return true;
}

int record(const std::string& path) {
  const auto sqp = std::make_unique<sqp::Sqp>();
  std::vector<RecordedProblem> problems;
  int seed = 0;
  int fell = 0;
  while (problems.size() < kProblems) {
    Random random(static_cast<std::uint64_t>(++seed));
    RecordedProblem problem{drawn_question(random), {}};
    if (!walk_there(random, problem.question)) {
      ++fell;
      continue;
    }
    disturb(random, problem.question);
    if (answer(random, problem, *sqp)) problems.push_back(std::move(problem));
    std::fprintf(stderr, "\r%zu problems from %d candidates", problems.size(), seed);
  }
  write_problems(problems, path);
  std::fprintf(stderr, "\n%d candidates failed on the way, %d were slow or ambiguous\n", fell,
               seed - fell - static_cast<int>(problems.size()));
  return 0;
}

bool same(const RecordedOptimum& a, const RecordedOptimum& b) {
  return std::abs(a.cost - b.cost) < kSameCost * std::abs(a.cost) && distance(a, b) < kSameTrajectory;
}

/// Solves the problems of a file again; those that have the same optimum stay as they are.
int solve_again(const std::string& path) {
  const auto sqp = std::make_unique<sqp::Sqp>();
  std::vector<RecordedProblem> kept;
  int changed = 0, left_out = 0;
  std::uint64_t seed = 0;
  for (const RecordedProblem& before : read_problems(path)) {
    Random random(++seed);
    RecordedProblem problem = before;
    if (!answer(random, problem, *sqp)) {
      ++left_out;
      continue;
    }
    const bool stays = same(before.optimum, problem.optimum);
    changed += stays ? 0 : 1;
    kept.push_back(stays ? before : problem);
  }
  write_problems(kept, path);
  std::fprintf(stderr, "%zu problems, %d with another optimum; %d were slow or ambiguous and are left out\n",
               kept.size(), changed, left_out);
  return 0;
}

}  // namespace
}  // namespace stilt::testing_support

int main(int argc, char** argv) {
  const bool again = argc == 3 && std::string_view(argv[1]) == "--again";
  if (!again && (argc != 2 || argv[1][0] == '-')) {
    std::fprintf(stderr,
                 "usage: stilt_record_problems [--again] FILE, usually tests/data/recorded_problems.txt\n");
    return 2;
  }
  try {
    if (again) return stilt::testing_support::solve_again(argv[2]);
    return stilt::testing_support::record(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stilt_record_problems: %s\n", error.what());
    return 2;
  }
}
