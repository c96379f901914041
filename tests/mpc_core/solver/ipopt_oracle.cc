#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <algorithm>

#include "tests/mpc_core/solver/planning_nlp.h"

namespace stilt::testing_support {
namespace {

using Eigen::VectorXd;
using Ipopt::Index;
using Ipopt::Number;

/// PlanningNlp in Ipopt's interface.
class Adapter : public Ipopt::TNLP {
 public:
  Adapter(const PlanningNlp& nlp, const VectorXd& start, IpoptResult& result)
      : nlp_(nlp), start_(start), result_(result) {}

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = nlp_.variables();
    m = nlp_.constraints();
    nnz_jac_g = static_cast<Index>(nlp_.jacobian(start_).size());
    nnz_h_lag = static_cast<Index>(nlp_.hessian(start_, 1.0, VectorXd::Zero(m)).size());
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l, Number* g_u) override {
    std::fill(x_l, x_l + n, -1e20);
    std::fill(x_u, x_u + n, 1e20);
    std::fill(g_l, g_l + m, 0.0);
    std::fill(g_u, g_u + m, 0.0);
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy(start_.data(), start_.data() + n, x);
    return true;
  }

  bool eval_f(Index n, const Number* x, bool, Number& value) override {
    value = nlp_.objective(view(x, n));
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    VectorXd::Map(gradient, n) = nlp_.gradient(view(x, n));
    return true;
  }

  bool eval_g(Index n, const Number* x, bool, Index m, Number* g) override {
    VectorXd::Map(g, m) = nlp_.residuals(view(x, n));
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    write(nlp_.jacobian(x != nullptr ? view(x, n) : start_), rows, columns, values);
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number factor, Index m, const Number* lambda, bool, Index,
              Index* rows, Index* columns, Number* values) override {
    const bool structure = x == nullptr;
    write(nlp_.hessian(structure ? start_ : view(x, n), structure ? 1.0 : factor,
                       structure ? VectorXd(VectorXd::Zero(m)) : view(lambda, m)),
          rows, columns, values);
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn status, Index n, const Number* x, const Number*, const Number*,
                         Index, const Number*, const Number*, Number value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    result_.solved = status == Ipopt::SUCCESS;
    result_.cost = value;
    result_.v = view(x, n);
  }

 private:
  static VectorXd view(const Number* values, Index count) { return VectorXd::Map(values, count); }

  /// Ipopt asks for the places first, for the values later.
  static void write(const std::vector<PlanningNlp::Entry>& entries, Index* rows, Index* columns,
                    Number* values) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (rows != nullptr) rows[i] = entries[i].row;
      if (columns != nullptr) columns[i] = entries[i].column;
      if (values != nullptr) values[i] = entries[i].value;
    }
  }

  const PlanningNlp& nlp_;
  const VectorXd& start_;
  IpoptResult& result_;
};

}  // namespace

IpoptResult solve_with_ipopt(const PlanningNlp& nlp, const VectorXd& start) {
  IpoptResult result;
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  application->Options()->SetIntegerValue("print_level", 0);
  application->Options()->SetStringValue("sb", "yes");
  application->Options()->SetNumericValue("tol", 1e-10);
  application->Options()->SetIntegerValue("max_iter", 100);
  if (application->Initialize() != Ipopt::Solve_Succeeded) return result;
  const Ipopt::SmartPtr<Ipopt::TNLP> adapter = new Adapter(nlp, start, result);
  (void)application->OptimizeTNLP(adapter);
  if (Ipopt::IsValid(application->Statistics()))
    result.iterations = application->Statistics()->IterationCount();
  return result;
}

}  // namespace stilt::testing_support
