#include <gtest/gtest.h>

#include <random>

#include "mpc_core/control/torque_law.h"
#include "tests/mpc_core/control/sample_plan.h"

namespace stilt::control {
namespace {

using testing_support::kAfterSwitch;
using testing_support::kPlanEnd_s;
using testing_support::kPlanStart_s;
using testing_support::kSwitch_s;
using testing_support::sample_plan;

constexpr double kRounding = 1e-12;

double difference(const auto& a, const auto& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// Position and velocity of a cubic with random coefficients.
struct Cubic {
  model::PositionVector coefficient[4];

  explicit Cubic(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (auto& c : coefficient) c = testing_support::random_state(random).head<model::kPositions>();
  }
  [[nodiscard]] model::StateVector at(double t) const {
    model::StateVector state;
    state << coefficient[0] + t * (coefficient[1] + t * (coefficient[2] + t * coefficient[3])),
        coefficient[1] + t * (2.0 * coefficient[2] + 3.0 * t * coefficient[3]);
    return state;
  }
};

TEST(Interpolation, PositionsOfACubicMotionAreExact) {
  const auto plan = sample_plan(1);
  const Cubic motion(21);
  for (int k = 0; k < plan->nodes; ++k) plan->node[k].state = motion.at(plan->node[k].time_s - 1.0);
  for (double time_s = kPlanStart_s; time_s < kPlanEnd_s; time_s += 0.0007) {
    const model::StateVector point = interpolate(*plan, time_s).state;
    EXPECT_LT(difference(point.head<model::kPositions>(), motion.at(time_s - 1.0).head<model::kPositions>()),
              1e-10)
        << "at " << time_s;
  }
}

TEST(Interpolation, VelocitiesAreLinearBetweenNodes) {
  const auto plan = sample_plan(1);
  for (const int k : {0, 1, 3, 4}) {
    const PlanNode& from = plan->node[static_cast<std::size_t>(k)];
    const PlanNode& to = plan->node[static_cast<std::size_t>(k + 1)];
    for (const double s : {0.0, 0.25, 0.5, 0.9}) {
      const PlanPoint point = interpolate(*plan, from.time_s + s * (to.time_s - from.time_s));
      const model::StateVector expected = (1.0 - s) * from.state + s * to.state;
      EXPECT_LT(difference(point.state.tail<model::kPositions>(), expected.tail<model::kPositions>()), 1e-10)
          << "interval " << k << ", share " << s;
      EXPECT_EQ(point.gain, &from.gain);
    }
  }
}

TEST(Interpolation, InputsAreLinearWithinAContactPhase) {
  const auto plan = sample_plan(2);
  for (const int k : {0, 3}) {
    const PlanNode& from = plan->node[static_cast<std::size_t>(k)];
    const PlanNode& to = plan->node[static_cast<std::size_t>(k + 1)];
    for (const double s : {0.0, 0.3, 0.8}) {
      const PlanPoint point = interpolate(*plan, from.time_s + s * (to.time_s - from.time_s));
      const model::InputVector expected = (1.0 - s) * from.input + s * to.input;
      EXPECT_LT(difference(point.input, expected), 1e-10) << "interval " << k << ", share " << s;
    }
  }
}

TEST(Interpolation, InputsAreHeldAtTheEndOfAContactPhase) {
  const auto plan = sample_plan(3);
  for (const double time_s : {1.016, 1.02, 1.0299}) {
    const PlanPoint point = interpolate(*plan, time_s);
    EXPECT_EQ(difference(point.input, plan->node[1].input), 0.0) << time_s;
    EXPECT_EQ(point.mode, plan->node[1].mode);
  }
}

TEST(Interpolation, InputsAreHeldOverTheLastInterval) {
  const auto plan = sample_plan(4);
  EXPECT_EQ(difference(interpolate(*plan, 1.05).input, plan->node[4].input), 0.0);
}

TEST(Interpolation, JustBeforeASwitchTheStateIsTheOneBeforeIt) {
  const auto plan = sample_plan(5);
  const PlanPoint point = interpolate(*plan, kSwitch_s - 1e-13);
  EXPECT_LT(difference(point.state, plan->node[kAfterSwitch - 1].state), 1e-9);
  EXPECT_TRUE(point.mode.left);
  EXPECT_FALSE(point.mode.right);
}

TEST(Interpolation, AtASwitchTheStateIsTheOneAfterIt) {
  const auto plan = sample_plan(6);
  const PlanPoint point = interpolate(*plan, kSwitch_s);
  EXPECT_LT(difference(point.state, plan->node[kAfterSwitch].state), kRounding);
  EXPECT_LT(difference(point.input, plan->node[kAfterSwitch].input), kRounding);
  EXPECT_FALSE(point.mode.left);
  EXPECT_TRUE(point.mode.right);
}

TEST(Interpolation, TimesOutsideThePlanGiveItsEnds) {
  const auto plan = sample_plan(7);
  const PlanPoint before = interpolate(*plan, kPlanStart_s - 10.0);
  const PlanPoint after = interpolate(*plan, kPlanEnd_s + 10.0);
  EXPECT_LT(difference(before.state, plan->node[0].state), kRounding);
  EXPECT_LT(difference(before.input, plan->node[0].input), kRounding);
  EXPECT_LT(difference(after.state, plan->node[5].state), kRounding);
  EXPECT_LT(difference(after.input, plan->node[5].input), kRounding);
}

TEST(Interpolation, APlanOfTwoNodesIsEnough) {
  const auto plan = sample_plan(8);
  plan->nodes = 2;
  const PlanPoint point = interpolate(*plan, 1.0075);
  const model::StateVector middle = 0.5 * (plan->node[0].state + plan->node[1].state);
  EXPECT_LT(difference(point.state.tail<model::kPositions>(), middle.tail<model::kPositions>()), 1e-10);
  EXPECT_EQ(difference(point.input, plan->node[0].input), 0.0);
}

}  // namespace
}  // namespace stilt::control
