#include <cstddef>

#include "codegen/model/functions.h"

namespace stilt::codegen {
namespace {

FunctionSpec kinematics(const Equations& equations) {
  FunctionSpec spec{.name = "kinematics",
                    .documentation =
                        "Feet in the world frame, rows x and z of each foot in turn (SI):\n"
                        "foot_position, foot_velocity and foot_jacobian = d foot_position / d q.",
                    .parameters = {"x"},
                    .outputs = {}};
  Row position;
  Row velocity;
  Matrix jacobian;
  for (int f = 0; f < equations.tree().foot_count(); ++f) {
    const PlanarExpression p = equations.foot_position(f);
    const PlanarExpression v = equations.foot_velocity(f);
    position.insert(position.end(), {p.x, p.z});
    velocity.insert(velocity.end(), {v.x, v.z});
    for (const Row& row : equations.foot_jacobian(f)) jacobian.push_back(row);
  }
  append(spec.outputs, "foot_position", position);
  append(spec.outputs, "foot_velocity", velocity);
  append(spec.outputs, "foot_jacobian", jacobian);
  return spec;
}

FunctionSpec mass_matrix(const Equations& equations) {
  FunctionSpec spec{.name = "mass_matrix",
                    .documentation =
                        "Mass matrix over q (SI), armature on the diagonal of the joints.\n"
                        "joint_parameters: armature of each joint, then damping of each joint.",
                    .parameters = {"x", "joint_parameters"},
                    .outputs = {}};
  Matrix matrix = equations.mass_matrix();
  for (int j = 0; j < equations.tree().joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(3 + j);
    matrix[i][i] += equations.armature(j);
  }
  append(spec.outputs, "mass_matrix", matrix);
  return spec;
}

FunctionSpec bias(const Equations& equations) {
  FunctionSpec spec{
      .name = "bias",
      .documentation =
          "Generalised forces of Coriolis, centrifugal and gravity terms (N, Nm), without joint\n"
          "damping: mass_matrix a + bias = joint torques + foot_jacobian' forces.",
      .parameters = {"x"},
      .outputs = {}};
  Graph& graph = equations.graph();
  const Expression zero = graph.constant(0.0);
  AbsoluteMotion rest;
  rest.base_acceleration = {zero, graph.constant(kGravity_m_s2)};
  rest.rate = equations.rates();
  rest.acceleration.assign(rest.rate.size(), zero);
  rest.force.assign(equations.tree().feet.size(), {zero, zero});
  append(spec.outputs, "bias", equations.equations(rest).row);
  return spec;
}

}  // namespace

std::vector<FunctionSpec> kinematic_functions(const Equations& equations) {
  return {kinematics(equations), mass_matrix(equations), bias(equations)};
}

}  // namespace stilt::codegen
