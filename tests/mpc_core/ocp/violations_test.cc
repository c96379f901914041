#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/mpc_core/ocp/planning_scene.h"
#include "tests/robots.h"

namespace stilt::ocp {
namespace {

using model::kFeet;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;

void raise(double& largest, double violation) { largest = std::max(largest, violation); }

void check_flow(const ProblemData& data, const Stage& stage, const double* x, const double* u,
                Violations& v) {
  model::NodeTerms<double> node;
  data.robot->node(x, u, data.joint_parameters, node);
  for (int j = 0; j < kJoints; ++j) {
    const double position = x[kFirstJoint + j];
    const double velocity = x[kPositions + kFirstJoint + j];
    const double torque = node.joint_torque[j];
    const double slope = data.limits.torque_speed_slope_Nms_rad[j];
    const double forward_Nm = std::max(0.0, data.limits.torque_Nm[j] - slope * std::max(velocity, 0.0));
    const double backward_Nm = std::max(0.0, data.limits.torque_Nm[j] - slope * std::max(-velocity, 0.0));
    raise(v.position_violation_max_rad, data.limits.position_min_rad[j] - position);
    raise(v.position_violation_max_rad, position - data.limits.position_max_rad[j]);
    raise(v.velocity_violation_max_rad_s, std::abs(velocity) - data.limits.velocity_rad_s[j]);
    raise(v.torque_violation_max_Nm, torque - forward_Nm);
    raise(v.torque_violation_max_Nm, -torque - backward_Nm);
  }
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!stage.mode[foot]) continue;
    const double fx = u[kJoints + 2 * foot];
    const double fz = u[kJoints + 2 * foot + 1];
    raise(v.friction_cone_violation_max_N,
          std::abs(fx) - data.inequality.friction_coefficient * std::max(fz, 0.0));
    raise(v.pulling_force_max_N, -fz);
  }
}

void check_transition(const ProblemData& data, const Stage& stage, const double* x, Violations& v) {
  model::ImpactTerms<double> impact;
  data.robot->impact(stage.mode, x, data.joint_parameters, impact);
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!stage.mode[foot]) continue;
    raise(v.impulse_cone_violation_max_Ns,
          std::abs(impact.impulse[2 * foot]) -
              data.inequality.friction_coefficient * impact.impulse[2 * foot + 1]);
  }
}

/// Stage by stage, in doubles.
Violations scalar_violations(const ProblemData& data, const Problem& problem, const Trajectory& iterate) {
  Violations v;
  for (int k = 0; k < problem.horizon.stages; ++k) {
    const Stage& stage = problem.horizon.stage[k];
    if (stage.kind == StageKind::flow) check_flow(data, stage, iterate.x[k], iterate.u[k], v);
    if (stage.kind == StageKind::transition && data.discretisation.transition == Transition::impact)
      check_transition(data, stage, iterate.x[k], v);
  }
  return v;
}

void expect_same(const Violations& batched, const Violations& scalar) {
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-9 * (1.0 + std::abs(b))); };
  near(batched.friction_cone_violation_max_N, scalar.friction_cone_violation_max_N);
  near(batched.pulling_force_max_N, scalar.pulling_force_max_N);
  near(batched.impulse_cone_violation_max_Ns, scalar.impulse_cone_violation_max_Ns);
  near(batched.torque_violation_max_Nm, scalar.torque_violation_max_Nm);
  near(batched.position_violation_max_rad, scalar.position_violation_max_rad);
  near(batched.velocity_violation_max_rad_s, scalar.velocity_violation_max_rad_s);
}

TEST(Violations, OfAWalkingHorizonAreTheLargestOfItsStages) {
  for (const model::RobotModel* robot : {&testing_support::amber3m(), &testing_support::rabbit()}) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      SCOPED_TRACE(testing::Message() << robot->constants.name << " seed " << seed);
      testing_support::SceneOptions options;
      options.robot = robot;
      options.horizon_s = 1.0;
      options.transition = seed % 5 == 0 ? Transition::identity : Transition::impact;
      const auto scene = testing_support::walking_scene(options);
      testing_support::disturb(scene->guess, scene->problem.horizon.stages,
                               0.3 * static_cast<double>(seed % 7), seed);
      expect_same(violations(scene->data, scene->problem, scene->guess),
                  scalar_violations(scene->data, scene->problem, scene->guess));
    }
  }
}

TEST(Violations, OfARandomIterateUnderATorqueSpeedLineAreTheLargestOfItsStages) {
  for (const model::ContactMode mode : testing_support::kAllModes) {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      SCOPED_TRACE(testing::Message() << "L" << mode.left << " R" << mode.right << " seed " << seed);
      const auto scene = testing_support::random_scene(testing_support::amber3m(), mode, 7, seed);
      for (double& limit : scene->data.limits.torque_Nm) limit = 20.0;
      expect_same(violations(scene->data, scene->problem, scene->guess),
                  scalar_violations(scene->data, scene->problem, scene->guess));
    }
  }
}

TEST(Violations, OfAFootThatPullsAreItsForceAndNothingElse) {
  const auto scene = testing_support::walking_scene({});
  const Violations before = violations(scene->data, scene->problem, scene->guess);
  EXPECT_EQ(before.pulling_force_max_N, 0.0);
  for (int k = 0; k < scene->problem.horizon.stages; ++k) {
    const Stage& stage = scene->problem.horizon.stage[k];
    if (stage.kind != StageKind::flow || !stage.mode.left) continue;
    scene->guess.u[k][kJoints + 1] = -7.0;
    break;
  }
  const Violations after = violations(scene->data, scene->problem, scene->guess);
  EXPECT_EQ(after.pulling_force_max_N, 7.0);
  EXPECT_EQ(after.position_violation_max_rad, before.position_violation_max_rad);
  EXPECT_EQ(after.impulse_cone_violation_max_Ns, before.impulse_cone_violation_max_Ns);
}

}  // namespace
}  // namespace stilt::ocp
