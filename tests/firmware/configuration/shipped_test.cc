#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/schema.h"

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

TEST_P(Shipped, HoldsEveryKeyUnderTheDescriptionOfTheSchema) {
  std::istringstream lines{std::string(configuration().text)};
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
      ASSERT_NE(entry, nullptr) << line;
      EXPECT_NE(comment.find(describe(*entry)), std::string::npos)
          << entry->name()
          << " is not documented as in schema.cc; build stilt_write_configuration and run it on "
          << configuration().path;
      found.push_back(entry->name());
    }
    comment.clear();
  }
  for (const Entry& entry : entries()) {
    EXPECT_NE(std::ranges::find(found, entry.name()), found.end())
        << entry.name() << " is missing; build stilt_write_configuration and run it on "
        << configuration().path;
  }
}

INSTANTIATE_TEST_SUITE_P(Configurations, Shipped, testing::Values("amber3m", "rabbit"),
                         [](const auto& instance) { return instance.param; });

TEST(LoadRobot, AnUnknownRobotIsRefusedWithTheKnownOnes) {
  const Result result = load_robot("atlas");
  ASSERT_FALSE(result);
  EXPECT_EQ(to_string(result.error()),
            "--robot: there is no configuration for \"atlas\"; known robots are amber3m, amber3m_2020, rabbit");
}

TEST(LoadRobot, OverridesApplyToTheShippedFile) {
  const std::vector<Override> overrides = {{"discretisation.horizon_s=0.5"}};
  const Result result = load_robot("amber3m", overrides);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->discretisation.horizon_s, 0.5);
}

}  // namespace
}  // namespace stilt::configuration
