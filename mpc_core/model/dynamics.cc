#include <algorithm>

#include "codegen/generated/five_link/impact.h"
#include "codegen/generated/five_link/kinematics.h"
#include "codegen/generated/five_link/node.h"
#include "mpc_core/model/batch.h"
#include "mpc_core/model/leg_exchange.h"
#include "mpc_core/model/robot.h"

/// The generated functions of a robot, compiled once for double and once for batches.
namespace stilt::model {
namespace {

namespace five_link = generated::five_link;

/// The coefficients as arguments of the generated functions; batches have each in all lanes.
template <class T>
Coefficients<T> coefficients_of(const RobotModel& robot) noexcept {
  Coefficients<T> result;
  for (int i = 0; i < five_link::kCoefficientCount; ++i) {
    result.coefficient[i] = T(robot.coefficients.coefficient[i]);
  }
  return result;
}

/// No impulse at feet `first_foot` and later.
template <class T>
void clear_impulses(int first_foot, ImpactDerivatives<T>& out) noexcept {
  for (int r = 2 * first_foot; r < 2 * kFeet; ++r) {
    out.impulse[r] = T(0.0);
    for (T& element : out.impulse_dtheta[r]) element = T(0.0);
    for (T& element : out.impulse_dv[r]) element = T(0.0);
  }
}

/// Nothing changes.
template <class T>
void no_impact(const T* x, ImpactDerivatives<T>& out) noexcept {
  for (int r = 0; r < kPositions; ++r) {
    out.velocity_after[r] = x[kPositions + r];
    for (T& element : out.velocity_after_dtheta[r]) element = T(0.0);
    for (int c = 0; c < kPositions; ++c) out.velocity_after_dv[r][c] = T(r == c ? 1.0 : 0.0);
  }
  clear_impulses(0, out);
}

}  // namespace

template <class T>
void RobotModel::flow(const T* x, const T* u, FlowTerms<T>& out) const noexcept {
  five_link::flow(x, u, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::flow_derivatives(const T* x, const T* u, FlowDerivatives<T>& out) const noexcept {
  five_link::flow_derivatives(x, u, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::node(const T* x, const T* u, const T* p, NodeTerms<T>& out) const noexcept {
  five_link::node(x, u, p, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::node_derivatives(const T* x, const T* u, const T* p,
                                  NodeDerivatives<T>& out) const noexcept {
  five_link::node_derivatives(x, u, p, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::kinematics(const T* x, KinematicsTerms<T>& out) const noexcept {
  five_link::kinematics(x, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::impact(ContactMode contact, const T* x, const T* p, ImpactTerms<T>& out) const noexcept {
  const Coefficients<T> robot = coefficients_of<T>(*this);
  if (contact.count() == 2) return five_link::impact_both(x, p, robot.coefficient, out);
  out.impulse[2] = out.impulse[3] = T(0.0);
  if (contact.left) return five_link::impact_left(x, p, robot.coefficient, out);
  if (!contact.right) {
    std::copy(x + kPositions, x + kStates, out.velocity_after);
    out.impulse[0] = out.impulse[1] = T(0.0);
    return;
  }
  const ExchangedArguments<T> mirrored(x, p);
  ImpactTerms<T> left;
  left.impulse[2] = left.impulse[3] = T(0.0);
  five_link::impact_left(mirrored.x, mirrored.p, robot.coefficient, left);
  exchange_legs(left, out);
}

template <class T>
void RobotModel::impact_derivatives(ContactMode contact, const T* x, const T* p,
                                    ImpactDerivatives<T>& out) const noexcept {
  const Coefficients<T> robot = coefficients_of<T>(*this);
  if (contact.count() == 2) return five_link::impact_both_derivatives(x, p, robot.coefficient, out);
  if (contact.count() == 0) return no_impact(x, out);
  if (contact.left) {
    clear_impulses(1, out);
    return five_link::impact_left_derivatives(x, p, robot.coefficient, out);
  }
  const ExchangedArguments<T> mirrored(x, p);
  ImpactDerivatives<T> left;
  clear_impulses(1, left);
  five_link::impact_left_derivatives(mirrored.x, mirrored.p, robot.coefficient, left);
  exchange_legs(left, out);
}

template <class T>
void RobotModel::mass_matrix(const T* x, const T* p, MassMatrixTerms<T>& out) const noexcept {
  five_link::mass_matrix(x, p, coefficients_of<T>(*this).coefficient, out);
}

template <class T>
void RobotModel::bias(const T* x, BiasTerms<T>& out) const noexcept {
  five_link::bias(x, coefficients_of<T>(*this).coefficient, out);
}

template void RobotModel::flow(const double*, const double*, FlowTerms<double>&) const noexcept;
template void RobotModel::flow_derivatives(const double*, const double*,
                                           FlowDerivatives<double>&) const noexcept;
template void RobotModel::node(const double*, const double*, const double*,
                               NodeTerms<double>&) const noexcept;
template void RobotModel::node_derivatives(const double*, const double*, const double*,
                                           NodeDerivatives<double>&) const noexcept;
template void RobotModel::kinematics(const double*, KinematicsTerms<double>&) const noexcept;
template void RobotModel::impact(ContactMode, const double*, const double*,
                                 ImpactTerms<double>&) const noexcept;
template void RobotModel::impact_derivatives(ContactMode, const double*, const double*,
                                             ImpactDerivatives<double>&) const noexcept;
template void RobotModel::mass_matrix(const double*, const double*, MassMatrixTerms<double>&) const noexcept;
template void RobotModel::bias(const double*, BiasTerms<double>&) const noexcept;

template void RobotModel::flow(const Batch*, const Batch*, FlowTerms<Batch>&) const noexcept;
template void RobotModel::flow_derivatives(const Batch*, const Batch*,
                                           FlowDerivatives<Batch>&) const noexcept;
template void RobotModel::node(const Batch*, const Batch*, const Batch*, NodeTerms<Batch>&) const noexcept;
template void RobotModel::node_derivatives(const Batch*, const Batch*, const Batch*,
                                           NodeDerivatives<Batch>&) const noexcept;
template void RobotModel::kinematics(const Batch*, KinematicsTerms<Batch>&) const noexcept;
template void RobotModel::impact(ContactMode, const Batch*, const Batch*, ImpactTerms<Batch>&) const noexcept;
template void RobotModel::impact_derivatives(ContactMode, const Batch*, const Batch*,
                                             ImpactDerivatives<Batch>&) const noexcept;
template void RobotModel::mass_matrix(const Batch*, const Batch*, MassMatrixTerms<Batch>&) const noexcept;
template void RobotModel::bias(const Batch*, BiasTerms<Batch>&) const noexcept;

}  // namespace stilt::model
