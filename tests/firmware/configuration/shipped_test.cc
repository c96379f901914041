#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/schema.h"
#include "firmware/robots/robots.h"
#include "tests/own_folder.h"

namespace stilt::configuration {
namespace {

class Shipped : public testing::TestWithParam<std::string> {
 protected:
  static const ShippedConfiguration& configuration() {
    for (const ShippedConfiguration& shipped : shipped_configurations()) {
      if (shipped.robot == GetParam()) return shipped;
    }
    throw std::runtime_error("no configuration of " + GetParam());
  }
};

TEST_P(Shipped, IsValid) {
  const Result result = load_robot(GetParam());
  EXPECT_TRUE(result) << to_string(result.error());
}

/// Names of the keys of a file, each documented as in the schema.
std::vector<std::string> documented_keys(const ShippedConfiguration& configuration) {
  std::istringstream lines{std::string(configuration.text)};
  std::string section, line;
  std::string comment;  // the comment lines just above
  std::vector<std::string> found;
  while (std::getline(lines, line)) {
    if (line.starts_with("# ")) {
      comment += line.substr(2) + '\n';
      continue;
    }
    if (line.starts_with('[')) section = line.substr(1, line.find(']') - 1);
    if (const std::size_t equals = line.find(" = "); equals != std::string::npos) {
      const Entry* entry = find_entry(section, line.substr(0, equals));
      if (entry == nullptr) throw std::runtime_error("unknown key: " + line);
      EXPECT_NE(comment.find(describe(*entry)), std::string::npos)
          << entry->name()
          << " is not documented as in schema.cc; build stilt_write_configuration and run it on "
          << configuration.path;
      found.push_back(entry->name());
    }
    comment.clear();
  }
  return found;
}

TEST_P(Shipped, DocumentsItsKeysAsTheSchemaDoes) { EXPECT_FALSE(documented_keys(configuration()).empty()); }

INSTANTIATE_TEST_SUITE_P(Configurations, Shipped, testing::Values("amber3m", "rabbit"),
                         [](const auto& instance) { return instance.param; });

const ShippedConfiguration& shipped(std::string_view robot) {
  return *std::ranges::find(shipped_configurations(), robot, &ShippedConfiguration::robot);
}

TEST(ShippedAmber3m, HoldsEveryKey) {
  const std::vector<std::string> found = documented_keys(shipped("amber3m"));
  for (const Entry& entry : entries()) {
    EXPECT_NE(std::ranges::find(found, entry.name()), found.end())
        << entry.name() << " is missing; build stilt_write_configuration and run it on amber3m.toml";
  }
}

TEST(ShippedRabbit, HoldsOnlyKeysThatDifferFromTheDefaults) {
  const Configuration defaults;
  const Result rabbit = load_robot("rabbit");
  ASSERT_TRUE(rabbit);
  for (const std::string& key : documented_keys(shipped("rabbit"))) {
    const std::size_t dot = key.find('.');
    const Entry* entry = find_entry(key.substr(0, dot), key.substr(dot + 1));
    EXPECT_NE(value_text(*entry, *rabbit), value_text(*entry, defaults)) << key << " is the default";
  }
}

/// A folder with the description of a robot that is not shipped.
class OwnRobot : public testing::Test {
 protected:
  OwnRobot() { std::filesystem::copy_file(STILT_TEST_DATA "/robots/heavy.urdf", urdf); }

  stilt::tests::OwnFolder folder;
  const std::string urdf = (folder.path() / "own.urdf").string();
};

TEST_F(OwnRobot, TakesTheTomlOfTheSameStemBesideIt) {
  std::ofstream(folder.path() / "own.toml") << "[reference]\nbase_height_m = 0.77\n";
  const Result result = load_robot(urdf);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->reference.base_height_m, 0.77);
  EXPECT_EQ(result->hardware.robot, urdf);
}

/// A key of no stance beside a URDF, in a file that names it, or in a file beside --robot changes none.
TEST_F(OwnRobot, StandsByTheLengthOfItsLegsWhateverElseIsSet) {
  const auto rabbit = std::ranges::find(robots::shipped_urdfs(), "rabbit", &robots::ShippedUrdf::name);
  std::ofstream(urdf) << rabbit->text;  // legs of 0.8 m: no default is right by chance
  const auto check = [](const Result& result, double height_m, double half_width_m) {
    ASSERT_TRUE(result) << to_string(result.error());
    EXPECT_DOUBLE_EQ(result->reference.base_height_m, height_m);
    EXPECT_DOUBLE_EQ(result->gait.stand_half_width_m, half_width_m);
  };
  const double height_m = 0.916 * 0.8, half_width_m = 0.172 * 0.8;
  const std::string beside = folder.file("own.toml"), other = folder.file("other.toml");
  check(load_robot(urdf), height_m, half_width_m);
  std::ofstream(beside) << "";
  check(load_robot(urdf), height_m, half_width_m);
  std::ofstream(beside) << "[sqp]\niterations = 3\n";
  check(load_robot(urdf), height_m, half_width_m);
  check(load(beside, urdf, {}), height_m, half_width_m);
  std::ofstream(other) << "[hardware]\nrobot = \"own.urdf\"\n";
  check(load_file(other), height_m, half_width_m);
  check(load(other, "amber3m", {}), Configuration().reference.base_height_m,
        Configuration().gait.stand_half_width_m);
  std::ofstream(beside) << "[gait]\nstand_half_width_m = 0.1\n";
  check(load_robot(urdf), height_m, 0.1);
  const std::vector<Override> overrides = {{"reference.base_height_m=0.7"}};
  check(load_robot(urdf, overrides), 0.7, 0.1);
}

TEST_F(OwnRobot, AStanceOutsideOfItsRangeIsThatOfTheRobot) {
  std::ifstream heavy(STILT_TEST_DATA "/robots/heavy.urdf");
  std::string text((std::istreambuf_iterator<char>(heavy)), std::istreambuf_iterator<char>());
  for (std::size_t at = 0; (at = text.find("-0.4064", at)) != std::string::npos; at += 6)
    text.replace(at, 7, "-2.4064");
  std::ofstream(urdf) << text;
  std::ofstream(folder.file("own.toml")) << "[sqp]\niterations = 3\n";
  const Result result = load_robot(urdf);
  ASSERT_FALSE(result);
  EXPECT_TRUE(to_string(result.error()).starts_with("--robot: reference.base_height_m = 2.6"))
      << to_string(result.error());
}

TEST_F(OwnRobot, AMistakeInItsTomlNamesThatFile) {
  std::ofstream(folder.path() / "own.toml") << "[reference]\nbase_height_m = \"high\"\n";
  const Result result = load_robot(urdf);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().front().file, (folder.path() / "own.toml").string());
  EXPECT_EQ(result.error().front().line, 2);
}

/// Shares of 0.8731 m that the shipped AMBER-3M has: 0.8 m and 0.15 m.
TEST_F(OwnRobot, WithoutATomlStandsByTheLengthOfItsLegs) {
  const Result result = load_robot(urdf);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_NEAR(result->reference.base_height_m, 0.8, 1e-3);
  EXPECT_NEAR(result->gait.stand_half_width_m, 0.15, 1e-3);
  EXPECT_EQ(result->hardware.robot, urdf);
}

TEST_F(OwnRobot, OverridesComeAfterWhatIsDerived) {
  const std::vector<Override> overrides = {{"reference.base_height_m=0.7"}};
  const Result result = load_robot(urdf, overrides);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->reference.base_height_m, 0.7);
}

TEST(LoadRobot, AnUnknownRobotIsRefusedWithTheKnownOnes) {
  const Result result = load_robot("atlas");
  ASSERT_FALSE(result);
  EXPECT_EQ(to_string(result.error()),
            "--robot: there is no robot \"atlas\"; known robots are amber3m, amber3m_2020, rabbit; or give a "
            "file that "
            "ends in .urdf");
}

TEST(LoadRobot, OverridesApplyToTheShippedFile) {
  const std::vector<Override> overrides = {{"discretisation.horizon_s=0.5"}};
  const Result result = load_robot("amber3m", overrides);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->discretisation.horizon_s, 0.5);
}

}  // namespace
}  // namespace stilt::configuration
