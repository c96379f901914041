#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "firmware/control_loop/plan_checksum.h"
#include "firmware/control_loop/planner_task.h"

namespace stilt::control_loop {
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
  EXPECT_TRUE(differs([](control::Plan& p) { p.start_time_s = std::nextafter(p.start_time_s, 4); }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.gait = gait::GaitKind::walk; }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.node[2].time_s = std::nextafter(p.node[2].time_s, 4); }));
  EXPECT_TRUE(differs([](control::Plan& p) { p.phase_end_s = 1e-300; }));
}

TEST(PlanChecksum, does_not_see_what_is_beyond_the_plan) {
  const auto plan = some_plan(10, 0.015);
  const std::uint64_t sum = plan_checksum(*plan);
  plan->node[10].state.setConstant(7);
  EXPECT_EQ(plan_checksum(*plan), sum);
}

TEST(PlanPreview, has_first_and_last_node_and_the_spacing_between) {
  const auto plan = some_plan(67, 0.015);
  PlanPreview preview;
  preview_plan(*plan, 0.03, preview);
  ASSERT_EQ(preview.count, 34);
  EXPECT_EQ(preview.sequence, 4);
  EXPECT_EQ(preview.node[0].time_s, 3.0);
  EXPECT_EQ(preview.node[33].time_s, plan->node[66].time_s);
  EXPECT_EQ(preview.node[1].state, plan->node[2].state);
  EXPECT_EQ(preview.node[1].input, plan->node[2].input);
}

TEST(PlanPreview, of_the_longest_plan_fits) {
  const auto plan = some_plan(control::kMaxNodes, 0.1);
  PlanPreview preview;
  preview_plan(*plan, 0.03, preview);
  EXPECT_LE(preview.count, PlanPreview::kMaxNodes);
  EXPECT_GT(preview.count, 30);
  EXPECT_EQ(preview.node[static_cast<std::size_t>(preview.count - 1)].time_s,
            plan->node[control::kMaxNodes - 1].time_s);
}

/// Records without solving: the plan in the mailbox is made by hand.
class PlannerTaskRecordTest : public testing::Test {
 protected:
  PlannerTaskRecordTest() { mail->plans.writer() = *some_plan(10, 0.015); }

  /// Records after a cycle at that time; fresh: with a usable plan.
  void record(double time_s, bool fresh = true) {
    PlanningRequest request;
    request.tick = 40;
    request.time_s = time_s;
    request.stance_episode = 2;
    planner->record(request, fresh, 700'000, *mail);
  }
  bool previews_at(double time_s, bool fresh = true) {
    static_cast<void>(mail->previews.newest());
    record(time_s, fresh);
    return mail->previews.has_news();
  }

  std::unique_ptr<Mailboxes> mail = std::make_unique<Mailboxes>();
  std::unique_ptr<PlannerTask> planner = std::make_unique<PlannerTask>();
};

TEST_F(PlannerTaskRecordTest, records_what_a_solve_was_given_and_came_to) {
  record(3.0);
  const CycleRecord* record = mail->cycles.front();
  ASSERT_NE(record, nullptr);
  EXPECT_EQ(record->tick, 40);
  EXPECT_EQ(record->time_s, 3.0);
  EXPECT_EQ(record->stance_episode, 2u);
  EXPECT_EQ(record->plan_sequence, 4);
  EXPECT_EQ(record->nodes, 10);
  EXPECT_EQ(record->checksum, plan_checksum(mail->plans.writer()));
  EXPECT_EQ(record->solve_ns, 700'000);
}

TEST_F(PlannerTaskRecordTest, records_no_plan_for_a_solve_that_gave_none) {
  record(3.0, false);
  const CycleRecord* record = mail->cycles.front();
  ASSERT_NE(record, nullptr);
  EXPECT_EQ(record->plan_sequence, -1);
  EXPECT_EQ(record->nodes, 0);
  EXPECT_EQ(record->checksum, 0u);
}

TEST_F(PlannerTaskRecordTest, previews_new_plans_at_most_thirty_times_per_second) {
  int previews = 0;
  for (int cycle = 0; cycle < 300; ++cycle) previews += previews_at(3.0 + 0.01 * cycle) ? 1 : 0;
  EXPECT_EQ(previews, 75) << "every fourth of 100 plans per second";
  EXPECT_EQ(mail->previews.newest().sequence, 4);
  EXPECT_GE(mail->previews.newest().count, 5);
  EXPECT_FALSE(previews_at(7.0, false)) << "no new plan";
}

TEST_F(PlannerTaskRecordTest, previews_again_when_time_goes_back) {
  EXPECT_TRUE(previews_at(8.0));
  EXPECT_TRUE(previews_at(1.0));
  EXPECT_FALSE(previews_at(1.01));
}

}  // namespace
}  // namespace stilt::control_loop
