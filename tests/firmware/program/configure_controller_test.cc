#include "firmware/program/configure_controller.h"

#include <gtest/gtest.h>

#include <memory>

#include "mpc_core/dispatch/dispatched_planner.h"

namespace stilt::program {
namespace {

TEST(ConfigureCycles, AnInstructionSetThatIsMissingIsNamedWithThoseThatAreNot) {
  const bool arm = dispatch::instruction_set_of_build() == model::InstructionSet::neon;
  configuration::Configuration configuration = configuration::load_robot("amber3m").value();
  configuration.sqp.instruction_set = arm ? model::InstructionSet::avx2 : model::InstructionSet::neon;
  const auto planner = std::make_unique<control_loop::PlannerTask>();
  const auto loop = std::make_unique<control_loop::ControlLoop>();
  const auto ready =
      configure_controller(configuration, "the recorded configuration", *planner, *loop, nullptr);
  ASSERT_FALSE(ready);
  EXPECT_NE(ready.error().find("the recorded configuration: sqp.instruction_set is "), std::string::npos);
  EXPECT_NE(ready.error().find(model::name_of(dispatch::instruction_set_of_build())), std::string::npos);
}

TEST(ConfigureCycles, GaitsOfARobotWithoutThemAreMissedWhereTheReferenceNeedsThem) {
  configuration::Configuration configuration = configuration::load_robot("rabbit").value();
  const auto planner = std::make_unique<control_loop::PlannerTask>();
  const auto loop = std::make_unique<control_loop::ControlLoop>();
  const auto gaits = std::make_unique<gait::GaitLibrary>();
  const auto configure = [&] {
    return configure_controller(configuration, "mine.toml", *planner, *loop, gaits.get());
  };
  EXPECT_TRUE(configure()) << "it has no level of gaits below its plans";
  configuration.controller.reference = configuration::ReferenceKind::hzd;
  const auto refused = configure();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(),
            "mine.toml: controller.reference is hzd, and no gaits of rabbit are shipped; plans follow "
            "shipped gaits alone here, so set controller.reference = \"heuristic\"");
  configuration.controller.reference = configuration::load_robot("rabbit")->controller.reference;
  configuration.supervisor.select_gait = true;
  const auto selected = configure();
  ASSERT_FALSE(selected);
  EXPECT_TRUE(
      selected.error().starts_with("mine.toml: supervisor.select_gait is true, and no gaits of rabbit"))
      << selected.error();
}

}  // namespace
}  // namespace stilt::program
