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

}  // namespace
}  // namespace stilt::program
