#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "mpc_core/sqp/sqp.h"
#include "mpc_core/sqp/terminal_cost.h"
#include "tests/mpc_core/ocp/planning_scene.h"

namespace stilt::sqp {

using testing_support::Scene;

/// A walking problem with its terminal cost, a solver, and an iterate that starts from the guess.
struct Solve {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Sqp> sqp = std::make_unique<Sqp>();
  std::unique_ptr<ocp::Trajectory> iterate;
  /// Tighter than as shipped: these tests are of converged solutions.
  SqpParameters parameters{.cost_tolerance = 1e-4, .violation_tolerance = 1e-3};

  explicit Solve(const testing_support::SceneOptions& options = {})
      : scene(testing_support::walking_scene(options)) {
    const model::StateVector standing =
        gait::standing_state(options.robot->constants, options.reference.base_height_m, 0.0, 0.15, true);
    EXPECT_TRUE(set_terminal_cost(scene->data, standing, *std::make_unique<TerminalCostWorkspace>()));
    iterate = std::make_unique<ocp::Trajectory>(scene->guess);
  }

  SolveReport run() { return sqp->solve(scene->data, scene->problem, parameters, *iterate); }
  SolveReport run(int iterations) {
    parameters.iterations = iterations;
    return run();
  }
  /// The solution to about nine digits: the next step, smaller still, changes the cost by its rounding.
  void converge() {
    const SqpParameters before = parameters;
    parameters.cost_tolerance = 0.0;
    parameters.step_tolerance = 1e-6;
    parameters.iterations = 100;
    EXPECT_EQ(run().status, SolveStatus::converged);
    parameters = before;
  }
  [[nodiscard]] int stages() const { return scene->problem.horizon.stages; }
  [[nodiscard]] ocp::Merit merit() const { return ocp::evaluate(scene->data, scene->problem, *iterate); }
  [[nodiscard]] double violation() const { return std::sqrt(merit().violation_squared); }
};

}  // namespace stilt::sqp
