#include <gtest/gtest.h>

#include <string>

#include "firmware/configuration/configuration.h"

// [supervisor]: what may be given.
namespace stilt::configuration {
namespace {

/// All diagnostics of a section, "" when it is accepted.
std::string mistakes(const std::string& lines) {
  const Result result = parse("[supervisor]\n" + lines, "robot.toml");
  return result ? "" : to_string(result.error());
}

// Settings that would switch a check of a robot off.
TEST(SupervisorKeys, ChecksOfTheSupervisorStayInEffect) {
  for (const char* key : {"settle_s = 1.01", "stand_pose_margin_rad = 0.51", "stance_margin_rad = 1.01"}) {
    EXPECT_NE(mistakes(std::string(key) + "\n"), "") << key;
  }
  EXPECT_EQ(mistakes("settle_s = 1\nstand_pose_margin_rad = 0.5\nstance_margin_rad = 1\n"), "");
}

TEST(SupervisorKeys, AGaitThatIsSelectedMustBeTracked) {
  EXPECT_EQ(mistakes("select_gait = true\n"), "");
  EXPECT_EQ(mistakes("select_gait = true\ntrack_gait = false\n"),
            "robot.toml:2:15: supervisor.select_gait = true needs supervisor.track_gait = true: no gait is "
            "tracked otherwise");
}

}  // namespace
}  // namespace stilt::configuration
