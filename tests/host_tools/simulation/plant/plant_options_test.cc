#include "host_tools/simulation/plant/plant_options.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {
namespace {

TEST(PlantOptions, EveryKeyOfTheTableTakesTheEndsOfItsRangeAndNothingBeyond) {
  for (const PlantOption& option : plant_option_table()) {
    const std::string key = std::string(option.key) + "=";
    PlantOptions options;
    EXPECT_NO_THROW(set_plant_option(options, key + number_text(option.minimum))) << key;
    EXPECT_NO_THROW(set_plant_option(options, key + number_text(option.maximum))) << key;
    const double beyond = option.maximum - option.minimum;
    for (const double value : {option.minimum - beyond, option.maximum + beyond}) {
      EXPECT_THROW(set_plant_option(options, key + number_text(value)), std::invalid_argument)
          << key << value;
    }
  }
}

TEST(PlantOptions, AssignmentsReachTheirField) {
  PlantOptions options;
  set_plant_option(options, "friction=0.4");
  set_plant_option(options, "armature=0");
  set_plant_option(options, "step_height_m=-0.02");
  EXPECT_EQ(options.friction, 0.4);
  EXPECT_EQ(options.armature_kg_m2, 0.0);
  EXPECT_EQ(options.step_height_m, -0.02);
}

TEST(PlantOptions, ASwitchTakesZeroAndOneOnly) {
  PlantOptions options;
  set_plant_option(options, "joint_stops=1");
  EXPECT_TRUE(options.joint_stops);
  set_plant_option(options, "joint_stops=0");
  EXPECT_FALSE(options.joint_stops);
  EXPECT_THROW(set_plant_option(options, "joint_stops=0.5"), std::invalid_argument);
  EXPECT_NE(describe_plant_options().find("(0 or 1; default 0)"), std::string::npos);
}

TEST(Numbers, DecimalsAreAsManyAsTheNumberHasAndAtLeastTwo) {
  EXPECT_EQ(decimals_text(0.5), "0.50");
  EXPECT_EQ(decimals_text(2.0), "2.00");
  EXPECT_EQ(decimals_text(2.0, 1), "2.0");
  EXPECT_EQ(decimals_text(0.501), "0.501");
  EXPECT_EQ(decimals_text(0.115), "0.115");
  EXPECT_EQ(decimals_text(0.05 * 3), "0.15") << "0.15000000000000002";
  EXPECT_EQ(decimals_text(-0.004), "-0.004");
  EXPECT_EQ(decimals_text(-0.0), "0.00");
  EXPECT_EQ(decimals_text(-1e-17), "0.00");
}

TEST(PlantOptions, UnknownKeysAndTextThatIsNoNumberAreRefusedInOneSentence) {
  for (const char* text : {"nope=1", "friction", "friction=", "friction=rough", "friction=0.4x", "=1", ""}) {
    PlantOptions options;
    try {
      set_plant_option(options, text);
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("--plant"), std::string::npos);
    }
  }
}

TEST(PlantOptions, TheDescriptionNamesEveryKeyWithItsRange) {
  const std::string text = describe_plant_options();
  for (const PlantOption& option : plant_option_table()) EXPECT_NE(text.find(option.key), std::string::npos);
  EXPECT_NE(text.find("0.01 to 5"), std::string::npos);
}

}  // namespace
}  // namespace stilt::simulation
