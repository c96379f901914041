#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"

namespace stilt::configuration {
namespace {

TEST(Preset, EveryShippedOneIsValidWithEveryShippedConfiguration) {
  ASSERT_FALSE(shipped_presets().empty());
  for (const ShippedPreset& preset : shipped_presets()) {
    for (const ShippedConfiguration& shipped : shipped_configurations()) {
      const Result result = load_robot(shipped.robot, {}, preset.name);
      EXPECT_TRUE(result) << preset.name << " with " << shipped.robot << ": " << to_string(result.error());
    }
  }
}

TEST(Preset, PaperPlansWithoutImpactsInStepsOfFourTenths) {
  const Result result = load_robot("amber3m", {}, "paper");
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->discretisation.transition, ocp::Transition::identity);
  EXPECT_EQ(result->gait.single_support_s, 0.4);
  EXPECT_EQ(result->cost.terminal, 1.0);
}

TEST(Preset, ComesAfterTheFileAndBeforeTheOverrides) {
  const std::string file =
      "[gait]\nsingle_support_s = 0.5\ntouchdown_velocity_m_s = -0.3\n[discretisation]\ntransition = "
      "\"impact\"\n";
  const std::vector<Override> overrides = {{"discretisation.transition=impact"}};
  const Result result = parse(file, "robot.toml", overrides, "paper");
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->gait.single_support_s, 0.4);
  EXPECT_EQ(result->gait.touchdown_velocity_m_s, -0.3) << "the preset leaves alone what it does not name";
  EXPECT_EQ(result->discretisation.transition, ocp::Transition::impact);
}

TEST(Preset, AnUnknownOneIsRefusedWithTheKnownOnes) {
  const Result result = load_robot("amber3m", {}, "nonsense");
  ASSERT_FALSE(result);
  EXPECT_EQ(to_string(result.error()), "--preset: there is no preset \"nonsense\"; known presets are paper");
}

TEST(Preset, MistakesOfTheFileKeepTheirPlaceAndComeFirst) {
  const std::vector<Override> overrides = {{"cost.nothing=1"}};
  const Result result = parse("[gait]\nswing_height_m = 9\n", "robot.toml", overrides, "paper");
  ASSERT_FALSE(result);
  ASSERT_EQ(result.error().size(), 2u) << to_string(result.error());
  EXPECT_EQ(to_string(result.error()[0]).find("robot.toml:2:18: gait.swing_height_m"), 0u);
  EXPECT_EQ(to_string(result.error()[1]).find("--set: unknown key cost.nothing"), 0u);
}

TEST(Preset, AContradictionIsReportedAtThePresetRatherThanAtTheFile) {
  const Result result =
      parse("[gait]\nsingle_support_s = 0.5\n[estimator]\nblend_s = 0.18\n", "robot.toml", {}, "paper");
  ASSERT_FALSE(result);
  EXPECT_EQ(to_string(result.error()).find("firmware/configuration/presets/paper.toml:4:20: "), 0u)
      << to_string(result.error());
}

}  // namespace
}  // namespace stilt::configuration
