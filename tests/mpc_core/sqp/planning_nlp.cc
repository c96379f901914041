#include "tests/mpc_core/sqp/planning_nlp.h"

#include <algorithm>

namespace stilt::testing_support {
namespace {

using model::kInputs;
using model::kStates;

}  // namespace

PlanningNlp::PlanningNlp(const Scene& scene) : scene_(scene), scalar_(scene.data) {
  constraints_ = kStates;  // the initial state
  for (int k = 0; k < scene.problem.horizon.stages; ++k) {
    const ocp::Stage& stage = scene.problem.horizon.stage[static_cast<std::size_t>(k)];
    const bool flow = stage.kind == ocp::StageKind::flow;
    Block block{};
    block.first_variable = variables_;
    block.variables = flow ? kStageVariables : kStates;
    block.next_state = variables_ + block.variables;
    block.first_row = constraints_;
    block.rows = kStates + (flow ? 6 - stage.mode.count() : 0);
    variables_ += block.variables;
    constraints_ += block.rows;
    blocks_.push_back(block);
  }
  last_state_ = variables_;
  variables_ += kStates;
}

Eigen::VectorXd PlanningNlp::pack(const ocp::Trajectory& iterate) const {
  Eigen::VectorXd v(variables_);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    v.segment(block.first_variable, block.variables) =
        stage_variables(iterate, static_cast<int>(k)).head(block.variables);
  }
  v.tail<kStates>() = Eigen::Map<const model::StateVector>(iterate.x[blocks_.size()]);
  return v;
}

void PlanningNlp::unpack(const Eigen::VectorXd& v, ocp::Trajectory& iterate) const {
  iterate = ocp::Trajectory{};
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const StageVector<double> z = local_variables(v, blocks_[k]);
    std::copy(z.data(), z.data() + kStates, iterate.x[k]);
    std::copy(z.data() + kStates, z.data() + kStageVariables, iterate.u[k]);
  }
  std::copy(v.data() + last_state_, v.data() + variables_, iterate.x[blocks_.size()]);
}

StageVector<double> PlanningNlp::local_variables(const Eigen::VectorXd& v, const Block& block) const {
  StageVector<double> z = StageVector<double>::Zero();
  z.head(block.variables) = v.segment(block.first_variable, block.variables);
  return z;
}

template <class T>
std::vector<T> PlanningNlp::local(int k, const StageVector<T>& z) const {
  const ocp::Stage& stage = scene_.problem.horizon.stage[static_cast<std::size_t>(k)];
  const gait::ReferencePoint& point = scene_.points[static_cast<std::size_t>(k)];
  const StateOf<T> x = z.template head<kStates>();
  const bool flow = stage.kind == ocp::StageKind::flow;
  std::vector<T> values;
  values.push_back(flow ? stage.duration_s * scalar_.running_cost(stage.mode, point, z)
                        : scalar_.touchdown_cost(stage, x));
  const StateOf<T> next = flow ? scalar_.step(z, stage.duration_s) : scalar_.transition(stage, x);
  values.insert(values.end(), next.data(), next.data() + kStates);
  if (flow) {
    const std::vector<T> rows = scalar_.equalities(stage.mode, point, z);
    values.insert(values.end(), rows.begin(), rows.end());
  }
  return values;
}

PlanningNlp::Bounds PlanningNlp::variable_bounds() const {
  const auto unlimited = Eigen::VectorXd::Constant(variables_, 1e20);
  return {-unlimited, unlimited};
}

PlanningNlp::Bounds PlanningNlp::constraint_bounds() const {
  const auto zero = Eigen::VectorXd::Zero(constraints_);
  return {zero, zero};
}

double PlanningNlp::objective(const Eigen::VectorXd& v) const {
  double cost = scalar_.terminal_cost(scene_.problem, v.data() + last_state_);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    cost += local(static_cast<int>(k), local_variables(v, blocks_[k]))[0];
  }
  return cost;
}

Eigen::VectorXd PlanningNlp::gradient(const Eigen::VectorXd& v) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(variables_);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    const auto cost = [&](const StageVector<Complex>& z) {
      return std::vector<Complex>{local(static_cast<int>(k), z)[0]};
    };
    result.segment(block.first_variable, block.variables) =
        testing_support::jacobian(cost, local_variables(v, block)).row(0).head(block.variables).transpose();
  }
  for (int r = 0; r < kStates; ++r) {
    for (int c = 0; c < kStates; ++c) {
      result[last_state_ + r] +=
          scene_.data.terminal_weight[c][r] * (v[last_state_ + c] - scene_.problem.x_ref_terminal[c]);
    }
  }
  return result;
}

Eigen::VectorXd PlanningNlp::constraints(const Eigen::VectorXd& v) const {
  Eigen::VectorXd result(constraints_);
  for (int i = 0; i < kStates; ++i) result[i] = v[i] - scene_.problem.x_initial[i];
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    const std::vector<double> values = local(static_cast<int>(k), local_variables(v, block));
    for (int r = 0; r < block.rows; ++r) {
      result[block.first_row + r] =
          values[static_cast<std::size_t>(r) + 1] - (r < kStates ? v[block.next_state + r] : 0.0);
    }
  }
  return result;
}

std::vector<PlanningNlp::Entry> PlanningNlp::jacobian(const Eigen::VectorXd& v) const {
  std::vector<Entry> entries;
  for (int i = 0; i < kStates; ++i) entries.push_back({i, i, 1.0});
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    const auto values = [&](const StageVector<Complex>& z) { return local(static_cast<int>(k), z); };
    const Eigen::MatrixXd slopes = testing_support::jacobian(values, local_variables(v, block));
    for (int r = 0; r < block.rows; ++r) {
      for (int c = 0; c < block.variables; ++c) {
        entries.push_back({block.first_row + r, block.first_variable + c, slopes(r + 1, c)});
      }
      if (r < kStates) entries.push_back({block.first_row + r, block.next_state + r, -1.0});
    }
  }
  return entries;
}

std::vector<PlanningNlp::Entry> PlanningNlp::hessian(const Eigen::VectorXd& v, double factor,
                                                     const Eigen::VectorXd& multipliers) const {
  constexpr double kDifference = 1e-5;
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    const StageVector<double> z = local_variables(v, block);
    const auto slope = [&](int along, int moved, double move) {
      StageVector<Complex> at = z.cast<Complex>();
      at[moved] += move;
      at[along] += Complex(0.0, kComplexStep);
      const std::vector<Complex> values = local(static_cast<int>(k), at);
      double sum = factor * values[0].imag();
      for (int r = 0; r < block.rows; ++r) {
        sum += multipliers[block.first_row + r] * values[static_cast<std::size_t>(r) + 1].imag();
      }
      return sum / kComplexStep;
    };
    for (int r = 0; r < block.variables; ++r) {
      for (int c = 0; c <= r; ++c) {
        const double second = (slope(r, c, kDifference) - slope(r, c, -kDifference)) / (2.0 * kDifference);
        entries.push_back({block.first_variable + r, block.first_variable + c, second});
      }
    }
  }
  for (int r = 0; r < kStates; ++r) {
    for (int c = 0; c <= r; ++c) {
      entries.push_back({last_state_ + r, last_state_ + c, factor * scene_.data.terminal_weight[c][r]});
    }
  }
  return entries;
}

}  // namespace stilt::testing_support
