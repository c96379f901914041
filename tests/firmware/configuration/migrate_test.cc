#include "firmware/configuration/migrate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/renames.h"
#include "firmware/configuration/schema.h"

namespace stilt::configuration {
namespace {

/// The text under the new names, or the error.
std::string migrated(std::string_view toml) {
  const auto migration = migrate(toml, "robot.toml");
  return migration ? migration->text : to_string(migration.error());
}

TEST(Renames, GiveKnownNamesForUnknownOnes) {
  for (const Rename& rename : renames()) {
    if (rename.key.empty()) {
      const auto is_section = [](std::string_view name) {
        return std::ranges::any_of(sections(), [&](const Section& section) { return section.name == name; });
      };
      EXPECT_TRUE(is_section(rename.now)) << rename.now;
      EXPECT_FALSE(is_section(rename.section)) << rename.section;
    } else {
      EXPECT_NE(find_entry(rename.section, rename.now), nullptr) << rename.now;
      EXPECT_EQ(find_entry(rename.section, rename.key), nullptr) << rename.key;
    }
  }
}

TEST(Migrate, EveryOldNameIsRenamedAndThenRead) {
  for (const Rename& rename : renames()) {
    const std::string key = rename.key.empty() ? "rate_hz" : std::string(rename.key);
    const std::string toml = '[' + std::string(rename.section) + "]\n" + key + " = 1\n";
    EXPECT_FALSE(parse(toml, "robot.toml")) << toml;
    if (!rename.value_change.empty()) continue;
    const auto migration = migrate(toml, "robot.toml");
    ASSERT_TRUE(migration) << toml;
    EXPECT_EQ(migration->changes.size(), 1u) << toml;
    const Result result = parse(migration->text, "robot.toml");
    if (result) continue;
    for (const Diagnostic& diagnostic : result.error()) {  // of the value 1, which not every key takes
      EXPECT_EQ(diagnostic.message.find("unknown"), std::string::npos) << to_string(diagnostic);
      EXPECT_EQ(diagnostic.message.find("is now"), std::string::npos) << to_string(diagnostic);
    }
  }
}

TEST(Migrate, CommentsOrderAndValuesStay) {
  EXPECT_EQ(
      migrated("# friction_mu of äöü\r\n[inequality] # friction_mu\n  friction_mu=0.20 # friction_mu\n"
               "\"joint_torque_delta\" = 3 # ü\n\n[ cost ]\nbase_x = 1_000\n"),
      "# friction_mu of äöü\r\n[inequality] # friction_mu\n  friction_barrier_weight=0.20 # friction_mu\n"
      "\"joint_torque_barrier_width_Nm\" = 3 # ü\n\n[ cost ]\nbase_x = 1_000\n");
}

TEST(Migrate, KeysWrittenWithDotsOrInlineAreRenamed) {
  EXPECT_EQ(migrated("base_sensor.bus = 1\nbase_sensor.rate_hz = 2\nsqp.g_min = 3\n"),
            "torso_sensor.bus = 1\ntorso_sensor.rate_hz = 2\nsqp.filter_violation_min = 3\n");
  EXPECT_EQ(migrated("sqp = { \"ä\" = \"ä\", g_min = 3, gamma_c = 4 }\n"),
            "sqp = { \"ä\" = \"ä\", filter_violation_min = 3, filter_margin = 4 }\n");
}

TEST(Migrate, KeysOfTheSameNameInOtherSectionsStay) {
  EXPECT_EQ(migrated("[gait]\ng_max = 1\n"), "[gait]\ng_max = 1\n");
}

TEST(Migrate, AKeyUnderBothNamesIsRefused) {
  EXPECT_EQ(migrated("[sqp]\nfilter_margin = 1\ngamma_c = 2\n"),
            "robot.toml:3:1: gamma_c is now filter_margin, and the file has both; remove one of them");
}

/// The renamed header was refused as TOML before, at the place of the other one.
TEST(Migrate, ASectionUnderBothNamesIsToBeMerged) {
  const std::string sentence =
      "base_sensor is now torso_sensor, and the file has both; move the keys of base_sensor to torso_sensor";
  EXPECT_EQ(migrated("[base_sensor]\nbus = 1\n[torso_sensor]\nrate_hz = 250.0\n"),
            "robot.toml:1:2: " + sentence);
  EXPECT_EQ(migrated("[torso_sensor]\nrate_hz = 250.0\n[base_sensor]\nbus = 1\n"),
            "robot.toml:3:2: " + sentence);
  EXPECT_EQ(migrated("torso_sensor.bus = 1\nbase_sensor.bus = 2\n"), "robot.toml:2:1: " + sentence);
  EXPECT_EQ(migrated("torso_sensor.bus = 1\nbase_sensor.rate_hz = 2\n"),
            "torso_sensor.bus = 1\ntorso_sensor.rate_hz = 2\n")
      << "keys with dots stand beside each other";
}

TEST(Migrate, AMovedFileNamesTheSameRobot) {
  const std::string_view own = "[hardware]\nrobot = \"own.urdf\"  # mine\n";
  EXPECT_EQ(moved(own, "/a/robot.toml", "/b/robot.toml"), "[hardware]\nrobot = \"/a/own.urdf\"  # mine\n");
  EXPECT_EQ(moved("hardware.robot = \"../own.urdf\"\n", "/a/robot.toml", "/a/b/robot.toml"),
            "hardware.robot = \"/a/../own.urdf\"\n");
  EXPECT_EQ(moved(own, "/a/robot.toml", "/a/b/../new.toml"), own);
  for (const std::string_view stays : {"[hardware]\nrobot = \"rabbit\"\n",
                                       "[hardware]\nrobot = \"/own.urdf\"\n", "[sqp]\niterations = 1\n"}) {
    EXPECT_EQ(moved(stays, "/a/robot.toml", "/b/robot.toml"), stays);
  }
}

TEST(Migrate, AKeyInAnotherUnitIsRefusedWithWhatToDo) {
  const std::string_view toml = "[sqp]\ng_max = 1\n[inequality]\nminimum_normal_force_N = 20\n";
  const std::string sentence =
      "robot.toml:4:1: minimum_normal_force_N is now minimum_normal_force_share, in another unit: divide its "
      "newtons by the weight of the robot";
  EXPECT_EQ(migrated(toml), sentence + ", then rename it by hand");
  const Result result = parse(toml, "robot.toml");
  ASSERT_FALSE(result);
  EXPECT_EQ(to_string(result.error().back()), sentence) << "no word of a migration that refuses it";
}

TEST(Migrate, TextThatIsNotTomlIsRefusedWithItsPlace) {
  EXPECT_TRUE(migrated("[sqp\n").starts_with("robot.toml:1:5: not valid TOML: ")) << migrated("[sqp\n");
}

}  // namespace
}  // namespace stilt::configuration
