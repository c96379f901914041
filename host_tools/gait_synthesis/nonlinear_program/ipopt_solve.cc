#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <algorithm>

#include "host_tools/gait_synthesis/nonlinear_program/nonlinear_program.h"

namespace stilt::nonlinear_program {
namespace {

using Eigen::VectorXd;
using Ipopt::Index;
using Ipopt::Number;

/// Adapts a NonlinearProgram to Ipopt's interface.
class Adapter : public Ipopt::TNLP {
 public:
  Adapter(const NonlinearProgram& program, const VectorXd& start, IpoptSolution& solution)
      : program_(program), start_(start), solution_(solution) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian_entries, Index& hessian_entries,
                    IndexStyleEnum& index_style) override {
    n = static_cast<Index>(start_.size());
    m = static_cast<Index>(program_.constraint_bounds().lower.size());
    jacobian_entries = static_cast<Index>(program_.jacobian(start_).size());
    hessian_entries = static_cast<Index>(program_.hessian(start_, 1.0, VectorXd::Zero(m)).size());
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l, Number* g_u) override {
    const NonlinearProgram::Bounds variables = program_.variable_bounds();
    const NonlinearProgram::Bounds constraints = program_.constraint_bounds();
    VectorXd::Map(x_l, n) = variables.lower;
    VectorXd::Map(x_u, n) = variables.upper;
    VectorXd::Map(g_l, m) = constraints.lower;
    VectorXd::Map(g_u, m) = constraints.upper;
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    VectorXd::Map(x, n) = start_;
    return true;
  }

  bool eval_f(Index n, const Number* x, bool, Number& value) override {
    value = program_.objective(view(x, n));
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    VectorXd::Map(gradient, n) = program_.gradient(view(x, n));
    return true;
  }

  bool eval_g(Index n, const Number* x, bool, Index m, Number* g) override {
    VectorXd::Map(g, m) = program_.constraints(view(x, n));
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    write(program_.jacobian(x != nullptr ? view(x, n) : start_), rows, columns, values);
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number factor, Index m, const Number* lambda, bool, Index,
              Index* rows, Index* columns, Number* values) override {
    const bool places_only = x == nullptr;
    write(program_.hessian(places_only ? start_ : view(x, n), places_only ? 1.0 : factor,
                           places_only ? VectorXd(VectorXd::Zero(m)) : view(lambda, m)),
          rows, columns, values);
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index,
                         const Number*, const Number*, Number value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    solution_.cost = value;
    solution_.v = view(x, n);
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number constraint_violation, Number, Number,
                             Number, Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    solution_.constraint_violation = constraint_violation;
    return true;
  }

 private:
  static VectorXd view(const Number* values, Index count) { return VectorXd::Map(values, count); }

  /// Ipopt requests the positions first, the values later.
  static void write(const std::vector<NonlinearProgram::Entry>& entries, Index* rows, Index* columns,
                    Number* values) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (rows != nullptr) rows[i] = entries[i].row;
      if (columns != nullptr) columns[i] = entries[i].column;
      if (values != nullptr) values[i] = entries[i].value;
    }
  }

  const NonlinearProgram& program_;
  const VectorXd& start_;
  IpoptSolution& solution_;
};

const char* text(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
      return "solved";
    case Ipopt::Solved_To_Acceptable_Level:
      return "the constraints hold roughly only";
    case Ipopt::Infeasible_Problem_Detected:
      return "nothing meets the constraints";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "iteration limit reached";
    case Ipopt::Maximum_CpuTime_Exceeded:
      return "time limit reached";
    case Ipopt::Restoration_Failed:
      return "no feasible point found";
    default:
      return "Ipopt failed";
  }
}

bool contradict(const NonlinearProgram::Bounds& bounds) {
  return (bounds.lower.array() > bounds.upper.array()).any();
}

}  // namespace

IpoptSolution solve(const NonlinearProgram& program, const VectorXd& start, const IpoptOptions& options) {
  IpoptSolution solution;
  if (contradict(program.variable_bounds()) || contradict(program.constraint_bounds())) {
    solution.status = "the limits contradict each other or the robot's";
    return solution;
  }
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  application->Options()->SetIntegerValue("print_level", 0);
  application->Options()->SetStringValue("sb", "yes");
  application->Options()->SetStringValue("linear_solver", "mumps");
  application->Options()->SetNumericValue("tol", options.tolerance);
  application->Options()->SetIntegerValue("max_iter", options.iterations_max);
  application->Options()->SetNumericValue("max_cpu_time", options.time_max_s);
  solution.status = "Ipopt could not be started";
  if (application->Initialize() != Ipopt::Solve_Succeeded) return solution;
  const Ipopt::SmartPtr<Ipopt::TNLP> adapter = new Adapter(program, start, solution);
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(adapter);
  solution.solved = status == Ipopt::Solve_Succeeded || (status == Ipopt::Solved_To_Acceptable_Level &&
                                                         solution.constraint_violation <= options.tolerance);
  solution.status = text(solution.solved ? Ipopt::Solve_Succeeded : status);
  if (Ipopt::IsValid(application->Statistics())) {
    solution.iterations = application->Statistics()->IterationCount();
  }
  return solution;
}

}  // namespace stilt::nonlinear_program
