#include "firmware/telemetry/tuner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <tuple>
#include <variant>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/consistency.h"
#include "firmware/configuration/schema.h"
#include "firmware/control_loop/planner_task.h"
#include "mpc_core/gait/reference.h"
#include "tests/robots.h"

namespace stilt::telemetry {
namespace {

class Tunables : public testing::Test {
 protected:
  configuration::Configuration configuration = configuration::load_robot("amber3m").value();
  std::unique_ptr<control_loop::Mailboxes> mail = std::make_unique<control_loop::Mailboxes>();
  Tuner tuner{configuration, testing_support::amber3m(), *mail};
};

TEST_F(Tunables, are_weights_gains_and_heights_and_start_as_configured) {
  bool weight = false, gain = false, swing = false, height = false;
  for (const auto& tunable : tuner.tunables()) {
    const std::string key = tunable.entry->name();
    weight = weight || key == "cost.base_vx";
    gain = gain || key == "torque_law.joint_kp_Nm_rad";
    swing = swing || key == "gait.swing_height_m";
    height = height || key == "reference.base_height_m";
    EXPECT_LE(tunable.minimum, tunable.start_value) << key;
    EXPECT_GE(tunable.maximum, tunable.start_value) << key;
    EXPECT_FALSE(key.starts_with("sqp.") || key.starts_with("timing.") || key.starts_with("supervisor."))
        << key;
  }
  EXPECT_TRUE(weight && gain && swing && height);
  EXPECT_EQ(tuner.number(), 0u);
}

TEST_F(Tunables, reach_torque_loop_and_planner_under_one_number) {
  EXPECT_EQ(tuner.set("torque_law.joint_kp_Nm_rad", 120), "");
  EXPECT_EQ(tuner.set("cost.base_vx", 50), "");
  ASSERT_TRUE(mail->torque_tunings.has_news());
  const control_loop::TorqueTuning& torque = mail->torque_tunings.newest();
  EXPECT_EQ(torque.number, 2u);
  EXPECT_EQ(torque.law.joint_kp_Nm_rad, 120);
  const control_loop::PlannerTuning& planner = mail->planner_tunings.newest();
  EXPECT_EQ(planner.number, 2u);
  EXPECT_EQ(planner.settings.parameters.cost.base_vx, 50);
  EXPECT_EQ(planner.settings.data.cost.base_vx, 50);
}

TEST_F(Tunables, may_change_by_a_factor_of_four_and_a_height_by_centimetres) {
  const double kp = configuration.torque_law.joint_kp_Nm_rad;
  const double height_m = configuration.reference.base_height_m;
  for (const auto& [key, right, wrong] :
       {std::tuple("torque_law.joint_kp_Nm_rad", 4 * kp, 4.01 * kp),
        {"torque_law.joint_kp_Nm_rad", kp / 4, kp / 4.01},
        {"reference.base_height_m", height_m + 0.0199, height_m + 0.0201},
        {"reference.base_height_m", height_m - 0.0799, height_m - 0.0801}}) {
    EXPECT_EQ(tuner.set(key, right), "");
    EXPECT_NE(tuner.set(key, wrong).find("outside its live range"), std::string::npos) << key << " " << wrong;
  }
}

TEST_F(Tunables, stay_within_the_range_of_their_key) {
  for (const auto& tunable : tuner.tunables()) {
    const auto& field = std::get<configuration::RealField>(tunable.entry->field);
    EXPECT_GE(tunable.minimum, field.min) << tunable.entry->name();
    EXPECT_LE(tunable.maximum, field.max) << tunable.entry->name();
  }
  // A key whose range ends within the factor.
  configuration::Configuration extreme = configuration;
  for (const configuration::Entry& entry : configuration::entries()) {
    if (entry.name() != "torque_law.joint_kp_Nm_rad") continue;
    const auto& field = std::get<configuration::RealField>(entry.field);
    field.set(extreme, field.max);
  }
  Tuner other(extreme, testing_support::amber3m(), *mail);
  EXPECT_NE(other.set("torque_law.joint_kp_Nm_rad", 1.01 * extreme.torque_law.joint_kp_Nm_rad), "");
}

TEST_F(Tunables, out_of_range_unknown_or_not_a_number_change_nothing_and_say_what_is_right) {
  EXPECT_NE(tuner.set("torque_law.joint_kp_Nm_rad", 1e4).find("outside its live range"), std::string::npos);
  EXPECT_NE(tuner.set("torque_law.joint_kp_Nm_rad", std::nan("")).find("live range"), std::string::npos);
  EXPECT_NE(tuner.set("sqp.iterations", 5).find("no key that may change"), std::string::npos);
  EXPECT_NE(tuner.set("nonsense", 5).find("no key that may change"), std::string::npos);
  EXPECT_EQ(tuner.number(), 0u);
  EXPECT_FALSE(mail->torque_tunings.has_news());
}

// -0.8 m/s over 0.4 s need 0.02 m.
TEST_F(Tunables, that_contradict_other_values_are_refused_as_in_a_file) {
  configuration.gait.single_support_s = 0.4;
  configuration.gait.touchdown_velocity_m_s = -0.8;
  configuration.gait.swing_height_m = 0.02;
  ASSERT_TRUE(configuration::contradictions(configuration).empty());
  Tuner low(configuration, testing_support::amber3m(), *mail);
  const std::string refused = low.set("gait.swing_height_m", 0.01);
  EXPECT_TRUE(
      refused.starts_with("gait.swing_height_m = 0.01: gait.touchdown_velocity_m_s = -0.8 is too fast"))
      << refused;
  EXPECT_EQ(low.number(), 0u);
  EXPECT_EQ(low.set("gait.swing_height_m", 0.021), "");
}

TEST_F(Tunables, that_the_legs_do_not_reach_are_refused) {
  configuration.reference.base_height_m = 0.85;
  Tuner high(configuration, testing_support::amber3m(), *mail);
  EXPECT_EQ(high.set("reference.base_height_m", 0.86), "");
  const std::string refused = high.set("reference.base_height_m", 0.865);
  EXPECT_TRUE(
      refused.starts_with("reference.base_height_m = 0.865: reference.base_height_m = 0.865 and gait."))
      << refused;
  EXPECT_EQ(high.number(), 1u);
}

/// A planner that got a weight live plans like one that was configured with it.
TEST_F(Tunables, give_the_plan_that_the_same_configuration_gives) {
  control_loop::PlanningRequest request;
  request.stance_episode = 1;
  request.state =
      gait::standing_state(testing_support::amber3m().constants, configuration.reference.base_height_m, 0,
                           configuration.gait.stand_half_width_m, true);
  request.state[model::kPositions] = 0.1;
  const auto plan_of = [&](control_loop::PlannerTask& planner) {
    auto plan = std::make_unique<control::Plan>();
    EXPECT_TRUE(planner.cycle(request, *plan));
    return plan;
  };
  auto tuned = std::make_unique<control_loop::PlannerTask>();
  auto configured = std::make_unique<control_loop::PlannerTask>();
  ASSERT_EQ(tuned->configure(testing_support::amber3m(), configuration), control::ConfigureStatus::ok);
  ASSERT_EQ(tuner.set("cost.base_vx", 80), "");
  tuned->tune(mail->planner_tunings.newest());
  EXPECT_EQ(tuned->tuning(), 1u);
  configuration::Configuration changed = configuration;
  changed.cost.base_vx = 80;
  ASSERT_EQ(configured->configure(testing_support::amber3m(), changed), control::ConfigureStatus::ok);
  const auto a = plan_of(*tuned);
  const auto b = plan_of(*configured);
  ASSERT_EQ(a->nodes, b->nodes);
  for (int k = 0; k < a->nodes; ++k) EXPECT_EQ(a->node[k].input, b->node[k].input) << k;
}

}  // namespace
}  // namespace stilt::telemetry
