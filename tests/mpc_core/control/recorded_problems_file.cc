#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "tests/mpc_core/control/recorded_problems.h"

namespace stilt::testing_support {
namespace {

constexpr int kQuestionDigits = std::numeric_limits<double>::max_digits10;
constexpr int kOptimumDigits = 13;

constexpr const char* kHeading =
    "# Planning problems and their optima, written by build/release/bin/stilt_record_problems; the seeds "
    "and\n"
    "# what was left out are explained in tests/mpc_core/control/record_problems.cc. SI units. A line is\n"
    "# robot gait(0 stand, 1 step, 2 walk) speed stop_time time horizon double_support speed_reference\n"
    "# speed_trim integrator(0 rk2, 1 rk4) transition(0 identity, 1 impact) state[14] | cost stages nodes, "
    "and\n"
    "# for each node: its index, state[14], input[8].\n";

void write_question(const PlanningQuestion& q, std::ostream& out) {
  out.precision(kQuestionDigits);
  out << q.robot << ' ' << static_cast<int>(q.command.kind) << ' ' << q.command.speed_m_s << ' '
      << q.stop_time_s << ' ' << q.time_s << ' ' << q.horizon_s << ' ' << q.double_support_s << ' '
      << q.speed_reference_m_s << ' ' << q.speed_trim_m_s << ' ' << static_cast<int>(q.integrator) << ' '
      << static_cast<int>(q.transition);
  for (const double value : q.state) out << ' ' << value;
}

void write_optimum(const RecordedOptimum& optimum, std::ostream& out) {
  out.precision(kOptimumDigits);
  out << " | " << optimum.cost << ' ' << optimum.stages << ' ' << optimum.nodes.size();
  for (const OptimalNode& node : optimum.nodes) {
    out << ' ' << node.node;
    for (const double value : node.state) out << ' ' << value;
    for (const double value : node.input) out << ' ' << value;
  }
  out << '\n';
}

RecordedProblem parsed(std::istream& in) {
  RecordedProblem problem;
  PlanningQuestion& q = problem.question;
  int kind = 0;
  int integrator = 0;
  int transition = 0;
  in >> q.robot >> kind >> q.command.speed_m_s >> q.stop_time_s >> q.time_s >> q.horizon_s >>
      q.double_support_s >> q.speed_reference_m_s >> q.speed_trim_m_s >> integrator >> transition;
  q.command.kind = static_cast<gait::GaitKind>(kind);
  q.integrator = static_cast<ocp::Integrator>(integrator);
  q.transition = static_cast<ocp::Transition>(transition);
  for (double& value : q.state) in >> value;
  std::string bar;
  std::size_t nodes = 0;
  in >> bar >> problem.optimum.cost >> problem.optimum.stages >> nodes;
  for (std::size_t n = 0; in && n < nodes; ++n) {
    OptimalNode node;
    in >> node.node;
    for (double& value : node.state) in >> value;
    for (double& value : node.input) in >> value;
    problem.optimum.nodes.push_back(node);
  }
  return problem;
}

}  // namespace

void write_problems(const std::vector<RecordedProblem>& problems, const std::string& path) {
  std::ofstream out(path);
  out << kHeading;
  for (const RecordedProblem& problem : problems) {
    write_question(problem.question, out);
    write_optimum(problem.optimum, out);
  }
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

std::vector<RecordedProblem> read_problems(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  std::vector<RecordedProblem> problems;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    problems.push_back(parsed(words));
    if (!words) throw std::runtime_error(path + ":" + std::to_string(number) + ": not a recorded problem");
  }
  return problems;
}

}  // namespace stilt::testing_support
