#include "tests/mpc_core/ocp/scalar_ocp.h"

#include <algorithm>
#include <cmath>

#include "tests/codegen/generated/robots.h"

namespace stilt::testing_support {
namespace {

using model::kFeet;
using model::kFirstJoint;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

double real_part(double value) { return value; }
double real_part(const Complex& value) { return value.real(); }

template <class T>
std::array<T, 2 * kJoints> joint_parameters(const ocp::ProblemData& data) {
  std::array<T, 2 * kJoints> p;
  std::ranges::copy(data.joint_parameters, p.begin());
  return p;
}

template <class T>
model::NodeTerms<T> node_terms(const ocp::ProblemData& data, const StageVector<T>& z) {
  const auto p = joint_parameters<T>(data);
  return AnyScalarRobot(*data.robot).node(z.data(), z.data() + kStates, p.data());
}

}  // namespace

template <class T>
T CostTerm<T>::value() const {
  if (barrier == nullptr) return 0.5 * weight * (y - reference) * (y - reference);
  if (real_part(y) > barrier->width) return -barrier->weight * std::log(y);
  const T t = (y - 2.0 * barrier->width) / barrier->width;
  return barrier->weight * (-std::log(barrier->width) + 0.5 * t * t - 0.5);
}

template <class T>
double CostTerm<T>::first() const {
  const double h = real_part(y);
  if (barrier == nullptr) return weight * (h - reference);
  if (h > barrier->width) return -barrier->weight / h;
  return barrier->weight * (h - 2.0 * barrier->width) / (barrier->width * barrier->width);
}

template <class T>
double CostTerm<T>::second() const {
  if (barrier == nullptr) return weight;
  const double h = std::max(real_part(y), barrier->width);
  return barrier->weight / (h * h);
}

template <class T>
StateOf<T> ScalarOcp::flow(const StateOf<T>& x, const T* u) const {
  const model::FlowTerms<T> terms = AnyScalarRobot(*data_.robot).flow(x.data(), u);
  StateOf<T> rate;
  for (int i = 0; i < kPositions; ++i) rate[i] = x[kPositions + i];
  for (int r = 0; r < 3; ++r) rate[kPositions + r] = terms.base_acceleration[r];
  for (int j = 0; j < kJoints; ++j) rate[kPositions + kFirstJoint + j] = u[j];
  return rate;
}

template <class T>
StateOf<T> ScalarOcp::step(const StageVector<T>& z, double duration_s) const {
  const StateOf<T> x = z.template head<kStates>();
  const T* u = z.data() + kStates;
  const T h = duration_s;
  const StateOf<T> k1 = flow<T>(x, u);
  if (data_.discretisation.integrator == ocp::Integrator::rk2) {
    const StateOf<T> k2 = flow<T>(x + h * k1, u);
    return x + T(0.5) * h * (k1 + k2);
  }
  const StateOf<T> k2 = flow<T>(x + T(0.5) * h * k1, u);
  const StateOf<T> k3 = flow<T>(x + T(0.5) * h * k2, u);
  const StateOf<T> k4 = flow<T>(x + h * k3, u);
  return x + h / T(6.0) * (k1 + T(2.0) * k2 + T(2.0) * k3 + k4);
}

template <class T>
std::vector<CostTerm<T>> ScalarOcp::cost_terms(model::ContactMode mode, const gait::ReferencePoint& reference,
                                               const StageVector<T>& z) const {
  const ocp::CostParameters& c = data_.cost;
  const ocp::InequalityParameters& q = data_.inequality;
  const ocp::JointLimits& limits = data_.limits;
  const model::NodeTerms<T> node = node_terms(data_, z);
  const double state_weight[kStates] = {
      c.base_x,         c.base_z,         c.base_pitch,     c.joint_position, c.joint_position,
      c.joint_position, c.joint_position, c.base_vx,        c.base_vz,        c.base_pitch_rate,
      c.joint_velocity, c.joint_velocity, c.joint_velocity, c.joint_velocity};
  std::vector<CostTerm<T>> terms;
  const auto square = [&](double weight, const T& y, double wanted) {
    terms.push_back({y, weight, wanted, nullptr});
  };
  const auto limit = [&](const ocp::BarrierParameters& barrier, const T& h) {
    terms.push_back({h, 0.0, 0.0, &barrier});
  };

  for (int i = 0; i < kStates; ++i) square(state_weight[i], z[i], reference.state[i]);
  for (int i = 0; i < kInputs; ++i) {
    square(i < kJoints ? c.joint_acceleration : c.contact_force, z[kStates + i], reference.input[i]);
  }
  for (int i = 0; i < 2 * kFeet; ++i) {
    square(c.foot_position, node.foot_position[i], reference.foot_position_W_m[i]);
    square(c.foot_velocity, node.foot_velocity[i], reference.foot_velocity_W_m_s[i]);
    square(c.foot_acceleration, node.foot_acceleration[i], reference.foot_acceleration_W_m_s2[i]);
  }
  for (int j = 0; j < kJoints; ++j) {
    const T position = z[kFirstJoint + j];
    const T velocity = z[kPositions + kFirstJoint + j];
    limit(q.joint_position, position - limits.position_min_rad[j]);
    limit(q.joint_position, limits.position_max_rad[j] - position);
    limit(q.joint_velocity, limits.velocity_rad_s[j] - velocity);
    limit(q.joint_velocity, limits.velocity_rad_s[j] + velocity);
    // A drive gives less torque the faster the joint moves in the torque's direction.
    const double slope = limits.torque_speed_slope_Nms_rad[j];
    const bool forward = real_part(velocity) > 0.0;
    const T up = forward ? T(limits.torque_Nm[j] - slope * velocity) : T(limits.torque_Nm[j]);
    const T down = forward ? T(limits.torque_Nm[j]) : T(limits.torque_Nm[j] + slope * velocity);
    limit(q.joint_torque, up - node.joint_torque[j]);
    limit(q.joint_torque, down + node.joint_torque[j]);
  }
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!mode[foot]) continue;
    const T fx = z[kStates + kJoints + 2 * foot];
    const T fz = z[kStates + kJoints + 2 * foot + 1];
    limit(q.friction, q.friction_coefficient * (fz - data_.minimum_normal_force_N(mode)) - fx);
    limit(q.friction, q.friction_coefficient * (fz - data_.minimum_normal_force_N(mode)) + fx);
  }
  return terms;
}

template <class T>
T ScalarOcp::running_cost(model::ContactMode mode, const gait::ReferencePoint& reference,
                          const StageVector<T>& z) const {
  T cost = 0.0;
  for (const CostTerm<T>& term : cost_terms(mode, reference, z)) cost += term.value();
  return cost;
}

template <class T>
std::vector<T> ScalarOcp::equalities(model::ContactMode mode, const gait::ReferencePoint& reference,
                                     const StageVector<T>& z) const {
  const ocp::EqualityParameters& p = data_.equality;
  const model::NodeTerms<T> node = node_terms(data_, z);
  std::vector<T> rows;
  for (int foot = 0; foot < kFeet; ++foot) {
    const int x_axis = 2 * foot;
    const int z_axis = 2 * foot + 1;
    if (mode[foot]) {
      rows.push_back(node.foot_acceleration[x_axis] + p.stance_kd_1_s * node.foot_velocity[x_axis]);
      rows.push_back(node.foot_acceleration[z_axis] + p.stance_kd_1_s * node.foot_velocity[z_axis]);
    } else {
      rows.push_back(node.foot_acceleration[z_axis] - reference.foot_acceleration_W_m_s2[z_axis] +
                     p.swing_kd_1_s * (node.foot_velocity[z_axis] - reference.foot_velocity_W_m_s[z_axis]) +
                     p.swing_kp_1_s2 * (node.foot_position[z_axis] - reference.foot_position_W_m[z_axis]));
      rows.push_back(z[kStates + kJoints + x_axis]);
      rows.push_back(z[kStates + kJoints + z_axis]);
    }
  }
  return rows;
}

template <class T>
StateOf<T> ScalarOcp::transition(const ocp::Stage& stage, const StateOf<T>& x) const {
  StateOf<T> after = x;
  if (data_.discretisation.transition == ocp::Transition::identity) return after;
  const auto p = joint_parameters<T>(data_);
  const model::ImpactTerms<T> impact = AnyScalarRobot(*data_.robot).impact(stage.mode, x.data(), p.data());
  for (int i = 0; i < kPositions; ++i) after[kPositions + i] = impact.velocity_after[i];
  return after;
}

template <class T>
std::vector<CostTerm<T>> ScalarOcp::touchdown_terms(const ocp::Stage& stage, const StateOf<T>& x) const {
  const model::KinematicsTerms<T> feet = AnyScalarRobot(*data_.robot).kinematics(x.data());
  const auto p = joint_parameters<T>(data_);
  const double mu = data_.inequality.friction_coefficient;
  std::vector<CostTerm<T>> terms;
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!stage.touchdown[static_cast<std::size_t>(foot)]) continue;
    terms.push_back({feet.foot_velocity[2 * foot], data_.cost.touchdown_velocity, 0.0, nullptr});
  }
  if (data_.discretisation.transition == ocp::Transition::identity) return terms;
  const model::ImpactTerms<T> impact = AnyScalarRobot(*data_.robot).impact(stage.mode, x.data(), p.data());
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!stage.mode[foot]) continue;
    for (const double sign : {1.0, -1.0}) {
      terms.push_back({mu * impact.impulse[2 * foot + 1] - sign * impact.impulse[2 * foot], 0.0, 0.0,
                       &data_.inequality.impulse});
    }
  }
  return terms;
}

template <class T>
T ScalarOcp::touchdown_cost(const ocp::Stage& stage, const StateOf<T>& x) const {
  T cost = 0.0;
  for (const CostTerm<T>& term : touchdown_terms(stage, x)) cost += term.value();
  return cost;
}

double ScalarOcp::terminal_cost(const ocp::Problem& problem, const double* x) const {
  double cost = 0.0;
  for (int r = 0; r < kStates; ++r) {
    for (int c = 0; c < kStates; ++c) {
      cost += 0.5 * (x[r] - problem.x_ref_terminal[r]) * data_.terminal_weight[c][r] *
              (x[c] - problem.x_ref_terminal[c]);
    }
  }
  return cost;
}

ocp::Merit ScalarOcp::evaluate(const ocp::Problem& problem, const std::vector<gait::ReferencePoint>& points,
                               const ocp::Trajectory& iterate) const {
  ocp::Merit merit;
  const auto add_defect = [&](const StateOf<double>& reached, const double* next) {
    for (int i = 0; i < kStates; ++i) {
      const double defect = reached[i] - next[i];
      merit.violation_squared += defect * defect;
      merit.dynamics_defect_max = std::max(merit.dynamics_defect_max, std::abs(defect));
    }
  };
  for (int k = 0; k < problem.horizon.stages; ++k) {
    const ocp::Stage& stage = problem.horizon.stage[static_cast<std::size_t>(k)];
    const StageVector<double> z = stage_variables(iterate, k);
    if (stage.kind == ocp::StageKind::transition) {
      merit.cost += touchdown_cost<double>(stage, z.head<kStates>());
      add_defect(transition<double>(stage, z.head<kStates>()), iterate.x[k + 1]);
      continue;
    }
    const gait::ReferencePoint& point = points[static_cast<std::size_t>(k)];
    merit.cost += stage.duration_s * running_cost(stage.mode, point, z);
    add_defect(step(z, stage.duration_s), iterate.x[k + 1]);
    for (const double residual : equalities(stage.mode, point, z)) {
      merit.violation_squared += stage.duration_s * stage.duration_s * residual * residual;
      merit.equality_violation_max = std::max(merit.equality_violation_max, std::abs(residual));
    }
  }
  merit.cost += terminal_cost(problem, iterate.x[problem.horizon.stages]);
  return merit;
}

StageVector<double> stage_variables(const ocp::Trajectory& iterate, int k) {
  StageVector<double> z;
  z << Eigen::Map<const model::StateVector>(iterate.x[k]), Eigen::Map<const model::InputVector>(iterate.u[k]);
  return z;
}

// The two number types of the tests.
template struct CostTerm<double>;
template struct CostTerm<Complex>;
#define STILT_INSTANTIATE(T)                                                                            \
  template StateOf<T> ScalarOcp::flow<T>(const StateOf<T>&, const T*) const;                            \
  template StateOf<T> ScalarOcp::step<T>(const StageVector<T>&, double) const;                          \
  template std::vector<CostTerm<T>> ScalarOcp::cost_terms<T>(                                           \
      model::ContactMode, const gait::ReferencePoint&, const StageVector<T>&) const;                    \
  template T ScalarOcp::running_cost<T>(model::ContactMode, const gait::ReferencePoint&,                \
                                        const StageVector<T>&) const;                                   \
  template std::vector<T> ScalarOcp::equalities<T>(model::ContactMode, const gait::ReferencePoint&,     \
                                                   const StageVector<T>&) const;                        \
  template StateOf<T> ScalarOcp::transition<T>(const ocp::Stage&, const StateOf<T>&) const;             \
  template std::vector<CostTerm<T>> ScalarOcp::touchdown_terms<T>(const ocp::Stage&, const StateOf<T>&) \
      const;                                                                                            \
  template T ScalarOcp::touchdown_cost<T>(const ocp::Stage&, const StateOf<T>&) const
STILT_INSTANTIATE(double);
STILT_INSTANTIATE(Complex);
#undef STILT_INSTANTIATE

}  // namespace stilt::testing_support
