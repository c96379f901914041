#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "host_tools/benchmark/linearised_problem.h"
#include "mpc_core/gait/reference.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/ocp/problem.h"
#include "tests/robots.h"
#include "tests/used_memory.h"

/// Planning problems for tests: the ones a walking robot meets, and random ones of a single contact mode.
namespace stilt::testing_support {

/// Limits, joint parameters, weights and the default parameters of a robot; no terminal weight.
[[nodiscard]] ocp::ProblemData default_data(const model::RobotModel& robot);

struct SceneOptions {
  const model::RobotModel* robot = &testing_support::amber3m();
  gait::GaitCommand command{gait::GaitKind::walk, 0.4};
  gait::GaitParameters gait{.single_support_s = 0.4};
  gait::ReferenceParameters reference;
  double horizon_s = 0.5;
  double time_s = 0.4;  ///< of the plan; the command is given at 0, standing
  ocp::Integrator integrator = ocp::Integrator::rk2;
  ocp::Transition transition = ocp::Transition::identity;
};

/// A planning problem with the reference of every stage and a initial guess (the initial state everywhere,
/// moving along with the reference in x).
struct Scene {
  ocp::ProblemData data;
  gait::ContactSchedule schedule;
  gait::HeuristicReference reference;
  ocp::Problem problem;
  std::vector<gait::ReferencePoint> points;
  ocp::Trajectory guess;
};

/// A robot in mid-stride: stance feet at rest on the ground, swing foot moving forward at twice the speed.
[[nodiscard]] std::unique_ptr<Scene> walking_scene(const SceneOptions& options);

/// `stages` flow stages of one contact mode with random durations, references, states and inputs.
[[nodiscard]] std::unique_ptr<Scene> random_scene(const model::RobotModel& robot, model::ContactMode mode,
                                                  int stages, std::uint64_t seed);

/// Adds noise to all states and inputs of the iterate; forces by ten times as much per newton.
void disturb(ocp::Trajectory& iterate, int stages, double size, std::uint64_t seed);

using benchmark::LqStage;

/// The quadratic model that StageModels gives, in memory that held NaN: whatever is read must have been
/// written.
struct Linearisation : benchmark::LinearisedProblem {
  Linearisation(const ocp::ProblemData& data, const ocp::Problem& problem, const ocp::Trajectory& iterate)
      : LinearisedProblem(*std::make_unique<InUsedMemory<ocp::StageModels>>(), data, problem, iterate) {}
};

/// X and W of du = u0 + X dx + W w, from their factors.
[[nodiscard]] Eigen::Matrix<double, model::kInputs, model::kStates> inputs_by_state(
    const LqStage& stage, const ocp::InputProjection& projection);
[[nodiscard]] Eigen::Matrix<double, model::kInputs, Eigen::Dynamic> inputs_by_free(
    const LqStage& stage, const ocp::InputProjection& projection);

inline constexpr model::ContactMode kAllModes[] = {
    {true, true}, {true, false}, {false, true}, {false, false}};

}  // namespace stilt::testing_support
