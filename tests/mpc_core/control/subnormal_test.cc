#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_law.h"
#include "tests/mpc_core/control/recorded_problems.h"
#include "tests/robots.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

/// Subnormal numbers cost the processor a detour of a hundred cycles and more per operation; no thread turns
/// them off (docs/decisions/0001-floating-point.md). The planner never meets one: the processor's sticky
/// flags show, independent of any clock.
namespace stilt::testing_support {
namespace {

#if defined(__SSE2__)
constexpr bool kHasFlags = true;
constexpr unsigned kSubnormalOperand = 1U << 1;
constexpr unsigned kUnderflow = 1U << 4;

void clear_flags() { _mm_setcsr(_mm_getcsr() & ~0x3FU); }
bool met_subnormals() { return (_mm_getcsr() & (kSubnormalOperand | kUnderflow)) != 0; }
#else
constexpr bool kHasFlags = false;
void clear_flags() {}
bool met_subnormals() { return false; }
#endif

class Subnormals : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kHasFlags) GTEST_SKIP() << "this processor's flags do not show it";
  }
};

TEST_F(Subnormals, TheFlagsShowThem) {
  volatile double tiny = 1e-300;
  clear_flags();
  EXPECT_FALSE(met_subnormals());
  volatile double product = tiny * 1e-10;
  EXPECT_TRUE(met_subnormals()) << "a result of " << product;
  clear_flags();
  volatile double sum = product + product;
  EXPECT_TRUE(met_subnormals()) << "an operand of " << sum;
}

TEST_F(Subnormals, NoneIsMetInTheRecordedProblems) {
  const auto sqp = std::make_unique<sqp::Sqp>();
  int number = 0;
  for (const RecordedProblem& recorded : read_problems(STILT_TEST_DATA "/recorded_problems.txt")) {
    const auto prepared = prepare(recorded.question);
    clear_flags();
    const sqp::SolveReport report =
        sqp->solve(prepared->data, prepared->problem, sqp::SqpParameters{}, prepared->guess);
    EXPECT_FALSE(met_subnormals()) << "problem " << number;
    EXPECT_TRUE(report.usable());
    ++number;
  }
}

TEST_F(Subnormals, NoneIsMetInAWalkHoweverLongTheSolverGoesOn) {
  control::ControllerParameters parameters;
  parameters.sqp.early_stop = false;
  const auto planner = std::make_unique<control::Planner>();
  const auto plan = std::make_unique<control::Plan>();
  ASSERT_EQ(planner->configure(testing_support::amber3m(), parameters), control::ConfigureStatus::ok);
  planner->reset(0.0);
  control::PlannerInput input{
      0.0,
      gait::standing_state(testing_support::amber3m().constants, 0.8, 0.0, 0.15, true),
      {gait::GaitKind::walk, 0.5}};
  for (int i = 0; i < 150; ++i) {
    clear_flags();
    ASSERT_TRUE(planner->plan(input, *plan).usable());
    ASSERT_FALSE(met_subnormals()) << "plan " << i;
    input.time_s += 0.01;
    input.state = control::interpolate(*plan, input.time_s).state;
  }
}

TEST_F(Subnormals, AMeasurementThatIsOneChangesNothingElse) {
  PlanningQuestion question;
  question.state = gait::standing_state(testing_support::amber3m().constants, 0.8, 0.0, 0.15, true);
  const auto solved = [&](double rate_rad_s) {
    question.state.tail<model::kPositions>().setConstant(rate_rad_s);
    auto prepared = prepare(question);
    const auto sqp = std::make_unique<sqp::Sqp>();
    const sqp::SolveReport report =
        sqp->solve(prepared->data, prepared->problem, sqp::SqpParameters{}, prepared->guess);
    return std::pair(report, sampled(*prepared, prepared->guess, report.cost));
  };
  const auto [still_report, still] = solved(0.0);
  const auto [subnormal_report, subnormal] = solved(5e-320);
  EXPECT_EQ(subnormal_report.iterations, still_report.iterations);
  EXPECT_EQ(subnormal_report.status, still_report.status);
  EXPECT_LT(distance(subnormal, still), 1e-12);
}

}  // namespace
}  // namespace stilt::testing_support
