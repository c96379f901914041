#include "firmware/controller/planning_turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "firmware/controller/plan_checksum.h"

namespace stilt::controller {
namespace {

/// A plan with other numbers everywhere.
std::unique_ptr<control::Plan> some_plan(int nodes, double step_s) {
  auto plan = std::make_unique<control::Plan>();
  plan->sequence = 4;
  plan->nodes = nodes;
  plan->start_time_s = 3.0;
  for (int k = 0; k < nodes; ++k) {
    control::PlanNode& node = plan->node[static_cast<std::size_t>(k)];
    node.time_s = 3.0 + k * step_s;
    node.state.setConstant(0.01 * k);
    node.input.setConstant(0.5 + k);
    node.gain.setConstant(-0.25 * k);
    node.mode = {k % 2 == 0, true};
  }
  return plan;
}

TEST(PlanChecksum, differs_when_any_bit_of_a_node_differs) {
  const auto plan = some_plan(10, 0.015);
  const std::uint64_t sum = plan_checksum(*plan);
  const auto differs = [&](auto&& change) {
    auto other = std::make_unique<control::Plan>(*plan);
    change(*other);
    return plan_checksum(*other) != sum;
  };
  EXPECT_EQ(plan_checksum(*plan), sum);
  EXPECT_TRUE(
      differs([](control::Plan& p) { p.node[9].gain(7, 13) = std::nextafter(p.node[9].gain(7, 13), 1); }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.node[0].state[13] = -0.0; }));
  EXPECT_TRUE(differs([](control::Plan& p) { std::swap(p.node[3].input, p.node[4].input); }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.node[5].mode.left = !p.node[5].mode.left; }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.nodes = 9; }));
  EXPECT_TRUE(differs([](control::Plan& p) { ++p.sequence; }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.phase_end_s = 1e-300; }));
}

TEST(PlanChecksum, does_not_see_what_is_beyond_the_plan) {
  const auto plan = some_plan(10, 0.015);
  const std::uint64_t sum = plan_checksum(*plan);
  plan->node[10].state.setConstant(7);
  EXPECT_EQ(plan_checksum(*plan), sum);
}

TEST(PlanSketch, has_first_and_last_node_and_the_spacing_between) {
  const auto plan = some_plan(67, 0.015);
  PlanSketch sketch;
  sketch_plan(*plan, 0.03, sketch);
  ASSERT_EQ(sketch.count, 34);
  EXPECT_EQ(sketch.sequence, 4);
  EXPECT_EQ(sketch.node[0].time_s, 3.0);
  EXPECT_EQ(sketch.node[33].time_s, plan->node[66].time_s);
  EXPECT_EQ(sketch.node[1].state, plan->node[2].state);
  EXPECT_EQ(sketch.node[1].input, plan->node[2].input);
}

TEST(PlanSketch, of_the_longest_plan_fits) {
  const auto plan = some_plan(control::kMaxNodes, 0.1);
  PlanSketch sketch;
  sketch_plan(*plan, 0.03, sketch);
  EXPECT_LE(sketch.count, PlanSketch::kMaxNodes);
  EXPECT_GT(sketch.count, 30);
  EXPECT_EQ(sketch.node[static_cast<std::size_t>(sketch.count - 1)].time_s,
            plan->node[control::kMaxNodes - 1].time_s);
}

}  // namespace
}  // namespace stilt::controller
