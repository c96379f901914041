#include "firmware/program/options.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stilt::program {
namespace {

std::expected<Options, std::string> read(std::vector<std::string> words) {
  words.insert(words.begin(), "stiltd");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  return read_options(static_cast<int>(pointers.size()), pointers.data(), "version");
}

std::string mistake(const std::vector<std::string>& words) {
  const auto options = read(words);
  return options ? "" : options.error();
}

TEST(Options, WithoutAnyTheShippedRobotWaitsIdle) {
  const auto options = read({});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(options->task, Task::control);
  EXPECT_FALSE(options->start);
  EXPECT_EQ(options->duration_s, 0.0);
  EXPECT_FALSE(options->lockstep);
  EXPECT_EQ(options->configuration.hardware.robot, "amber3m");
}

TEST(Options, BusesReplaceThoseOfTheConfigurationInTheirOrder) {
  const auto options = read({"--bus", "vcan0", "--bus", "loopback:right"});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(configuration::bus_names(options->configuration.hardware),
            (std::vector<std::string>{"vcan0", "loopback:right"}));
  EXPECT_NE(mistake({"--bus", "can0"}).find("--bus: hip_R.bus = 1, but hardware.buses names 1 bus"),
            std::string::npos);
}

TEST(Options, StartSaysGaitAndSpeed) {
  const auto walk = read({"--start", "walk@-0.25", "--duration", "12.5", "--lockstep", "--json", "-"});
  ASSERT_TRUE(walk) << walk.error();
  EXPECT_EQ(walk->start->kind, gait::GaitKind::walk);
  EXPECT_EQ(walk->start->speed_m_s, -0.25);
  EXPECT_EQ(walk->duration_s, 12.5);
  EXPECT_TRUE(walk->lockstep);
  EXPECT_EQ(walk->json_file, "-");
  EXPECT_EQ(read({"--start", "stand"})->start->kind, gait::GaitKind::stand);
  EXPECT_EQ(read({"--start", "step"})->start->kind, gait::GaitKind::step);
  for (const char* wrong : {"walk", "walk@", "walk@fast", "walk@9", "walk@nan", "run@1", "@1", "stand@"}) {
    EXPECT_NE(mistake({"--start", wrong}).find("expected stand, step, or walk@SPEED"), std::string::npos)
        << wrong;
  }
}

TEST(Options, MistakesOfTheConfigurationAreAllTold) {
  const std::string text = mistake({"--set", "gait.swing_height_m=5", "--set", "supervisor.hot=1"});
  EXPECT_NE(text.find("--set: gait.swing_height_m = 5 is outside its range"), std::string::npos);
  EXPECT_NE(text.find("--set: unknown key supervisor.hot; did you mean supervisor.hot_C?"),
            std::string::npos);
}

TEST(Options, APresetChangesTheConfigurationBeforeTheGaitsAndWhatTheUserSets) {
  const auto paper = read({"--preset", "paper", "--set", "cost.terminal=3"});
  ASSERT_TRUE(paper) << paper.error();
  EXPECT_EQ(paper->configuration.discretisation.transition, ocp::Transition::identity);
  EXPECT_EQ(paper->configuration.gait.single_support_s, 0.4);
  EXPECT_EQ(paper->configuration.cost.terminal, 3.0);
  EXPECT_EQ(paper->source, "the shipped configuration of amber3m, preset paper, --set cost.terminal=3");
  const auto around_gaits = read({"--preset", "paper", "--set", "controller.reference=hzd"});
  ASSERT_TRUE(around_gaits) << around_gaits.error();
  EXPECT_EQ(around_gaits->configuration.discretisation.transition, ocp::Transition::identity);
  EXPECT_NEAR(around_gaits->configuration.gait.single_support_s, 0.3, 1e-6)
      << "step time of the shipped gaits";
  EXPECT_EQ(around_gaits->configuration.cost.terminal, 10.0);
}

TEST(Options, AnUnknownPresetIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(mistake({"--preset", "nonsense"}),
            "--preset: there is no preset \"nonsense\"; known presets are paper");
}

TEST(Options, NumbersOutOfRangeAreRefused) {
  EXPECT_NE(mistake({"--duration", "-1"}), "");
  EXPECT_NE(mistake({"--duration", "nan"}), "");
  EXPECT_NE(mistake({"selftest", "--seconds", "0"}), "");
  EXPECT_NE(mistake({"--banana"}), "");
}

TEST(Options, TheSelfTestHasItsOwnOptions) {
  const auto options = read({"selftest", "--bus", "vcan0", "--bus", "vcan1", "--seconds", "2"});
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(options->task, Task::self_test);
  EXPECT_EQ(options->self_test_s, 2.0);
  EXPECT_EQ(configuration::bus_names(options->configuration.hardware).front(), "vcan0");
}

}  // namespace
}  // namespace stilt::program
