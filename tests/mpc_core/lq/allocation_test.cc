#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "firmware/realtime/allocation_counter.h"
#include "mpc_core/lq/care.h"
#include "tests/mpc_core/lq/random_lq.h"

namespace stilt::lq {
namespace {

TEST(SolverMemory, TheCounterSeesABlockTakenAndGivenBack) {
  if (!realtime::counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  const realtime::AllocationScope scope;
  void* volatile block = std::malloc(16);
  std::free(block);
  EXPECT_EQ(scope.count(), 2);
}

TEST(SolverMemory, SweepsAndSlopeAllocateNothing) {
  if (!realtime::counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  const testing::LqProblem problem = testing::random_problem(1, 134);
  testing::SweepStatus status;
  testing::LqSolution solution = testing::solve(problem, status);
  const auto workspace = std::make_unique<RiccatiWorkspace>();
  const std::vector<LqFirstOrder> stages = problem.first_orders();
  const realtime::AllocationScope scope;
  status = testing::backward_sweep(problem, solution.gains.data(), *workspace, solution.values.data());
  const double slope = forward_sweep(stages.data(), problem.inputs.data(), problem.count(), problem.terminal,
                                     solution.gains.data(), problem.x0, solution.steps.data());
  EXPECT_EQ(scope.count(), 0);
  EXPECT_TRUE(status.ok());
  EXPECT_TRUE(std::isfinite(slope));
}

TEST(SolverMemory, TheAlgebraicRiccatiEquationAllocatesNothing) {
  if (!realtime::counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  CareProblem problem{StateMatrix::Identity(), InputMatrix::Zero(), StateMatrix::Identity(),
                      InputWeight::Identity()};
  problem.A.diagonal(1).setOnes();
  problem.B.bottomRows<model::kInputs>().setIdentity();
  CareSolution solution;
  const auto workspace = std::make_unique<CareWorkspace>();
  const realtime::AllocationScope scope;
  const CareOutcome outcome = solve_care(problem, solution, *workspace);
  EXPECT_EQ(scope.count(), 0);
  EXPECT_EQ(outcome, CareOutcome::ok);
}

}  // namespace
}  // namespace stilt::lq
