#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/schema.h"
#include "tests/own_folder.h"

namespace stilt::configuration {
namespace {

/// All diagnostics as text, "" when the configuration is accepted.
std::string mistakes(std::string_view toml, std::vector<Override> overrides = {}) {
  const Result result = parse(toml, "robot.toml", overrides);
  return result ? "" : to_string(result.error());
}

/// Names of all sections, as a mistake lists them.
std::string section_names() {
  std::string names;
  for (const Section& section : sections()) names += (names.empty() ? "" : ", ") + std::string(section.name);
  return names;
}

TEST(Parse, AnEmptyFileGivesTheDefaults) {
  const Result result = parse("", "robot.toml");
  ASSERT_TRUE(result);
  EXPECT_EQ(to_toml(*result, ""), to_toml(Parameters{}, ""));
}

TEST(Parse, KeysSetTheirFields) {
  const Result result = parse(
      "[gait]\nsingle_support_s = 0.3\n[sqp]\niterations = 3\nearly_stop = false\n"
      "[discretisation]\nintegrator = \"rk4\"\n"
      "[inequality]\nfriction_barrier_weight = 1\njoint_torque_barrier_width_Nm = 2.5\n",
      "robot.toml");
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->gait.single_support_s, 0.3);
  EXPECT_EQ(result->sqp.iterations, 3);
  EXPECT_FALSE(result->sqp.early_stop);
  EXPECT_EQ(result->discretisation.integrator, ocp::Integrator::rk4);
  EXPECT_EQ(result->inequality.friction.weight, 1.0) << "a whole number is a number";
  EXPECT_EQ(result->inequality.joint_torque.width, 2.5);
}

TEST(Parse, EveryMistakeIsReportedAtItsPlaceInTheOrderOfTheFile) {
  EXPECT_EQ(
      mistakes("[gait]\n"
               "swing_heigth_m = 0.05\n"
               "single_support_s = \"long\"\n"
               "[costs]\n"
               "x = 1\n"
               "[discretisation]\n"
               "integrator = \"rk3\"\n"
               "horizon_s = -1\n"
               "base_x = 2\n"
               "[cost]\n"
               "base_x = [1, 2]\n"
               "[sqp]\n"
               "iterations = 2.5\n"
               "early_stop = 1\n"),
      "robot.toml:2:1: unknown key gait.swing_heigth_m; did you mean gait.swing_height_m?\n"
      "robot.toml:3:20: gait.single_support_s must be a number (0.1 to 2 s), not text\n"
      "robot.toml:4:2: unknown section costs; did you mean cost?\n"
      "robot.toml:7:14: discretisation.integrator must be \"rk2\" or \"rk4\", not \"rk3\"\n"
      "robot.toml:8:13: discretisation.horizon_s = -1 is outside its range, 0.05 to 10 s\n"
      "robot.toml:9:1: unknown key discretisation.base_x; did you mean cost.base_x?\n"
      "robot.toml:11:10: cost.base_x must be a single value (0 to 1e6 1/(m^2 s)), not a list, table or date\n"
      "robot.toml:13:14: sqp.iterations must be a whole number (1 to 100), not a number with a fraction\n"
      "robot.toml:14:14: sqp.early_stop must be true or false, not a whole number");
}

TEST(Parse, ASectionMustBeATable) {
  EXPECT_EQ(mistakes("cost = 3\n"), "robot.toml:1:1: cost must be a section of keys, [cost], not a value");
}

TEST(Parse, NumbersThatAreNotFiniteAreRefused) {
  for (const char* number : {"nan", "inf", "-inf", "+nan"}) {
    EXPECT_NE(
        mistakes(std::string("[cost]\nbase_x = ") + number + "\n").find("robot.toml:2:10: cost.base_x = "),
        std::string::npos)
        << number;
    EXPECT_TRUE(mistakes("", {{std::string("cost.base_x=") + number}}).starts_with("--set: cost.base_x "))
        << number;
  }
}

TEST(Parse, TextThatIsNotTomlIsRefusedWithItsPlace) {
  EXPECT_TRUE(mistakes("[gait\n").starts_with("robot.toml:1:6: not valid TOML: "));
  EXPECT_TRUE(
      mistakes("[gait]\nsingle_support_s = 0.4\nsingle_support_s = 0.5\n").starts_with("robot.toml:3:"))
      << "a key given twice";
}

TEST(Parse, AContradictionPointsAtTheValueThatCausesIt) {
  EXPECT_TRUE(mistakes("[discretisation]\ntime_step_s = 0.015\nhorizon_s = 3.0\n")
                  .starts_with("robot.toml:3:13: a horizon of 3 s"));
  EXPECT_TRUE(mistakes("[discretisation]\nhorizon_s = 2.0\n", {{"discretisation.time_step_s=0.01"}})
                  .starts_with("--set: a horizon of 2 s"))
      << "the override is what made a good file bad";
}

TEST(Override, TheLastOneOfAKeyCounts) {
  const std::vector<Override> overrides = {{"gait.swing_height_m=0.04"},
                                           {" gait.swing_height_m = 0.05 "},
                                           {"discretisation.integrator=rk4"},
                                           {"discretisation.transition=\"impact\""},
                                           {"sqp.early_stop=false"},
                                           {"sqp.iterations=1"},
                                           {"cost.base_x=1e2"}};
  const Result result = parse("[gait]\nswing_height_m = 0.07\n", "robot.toml", overrides);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->gait.swing_height_m, 0.05);
  EXPECT_EQ(result->discretisation.integrator, ocp::Integrator::rk4);
  EXPECT_EQ(result->discretisation.transition, ocp::Transition::impact);
  EXPECT_FALSE(result->sqp.early_stop);
  EXPECT_EQ(result->sqp.iterations, 1);
  EXPECT_EQ(result->cost.base_x, 100.0);
}

TEST(Override, MistakesNameTheOption) {
  EXPECT_EQ(mistakes("[gait]\nx = 1\n", {{"gait.swing_height_m"},
                                         {"swing_height_m=0.05"},
                                         {"gait.swing_hight_m=0.05"},
                                         {"walk.speed=1"},
                                         {"gait.swing_height_m=high"},
                                         {"gait.swing_height_m="},
                                         {"gait.swing_height_m=0.05m"},
                                         {"sqp.iterations=0", "--iterations"}}),
            "robot.toml:2:1: unknown key gait.x; the shipped files name every key\n"
            "--set: \"gait.swing_height_m\" must have the form section.key=value, such as "
            "discretisation.horizon_s=1.0\n"
            "--set: \"swing_height_m=0.05\" must have the form section.key=value, such as "
            "discretisation.horizon_s=1.0\n"
            "--set: unknown key gait.swing_hight_m; did you mean gait.swing_height_m?\n"
            "--set: unknown section walk; sections are " +
                section_names() +
                "\n"
                "--set: gait.swing_height_m must be a number (0.005 to 0.3 m), not text\n"
                "--set: gait.swing_height_m must be a number (0.005 to 0.3 m), not text\n"
                "--set: gait.swing_height_m must be a number (0.005 to 0.3 m), not text\n"
                "--iterations: sqp.iterations = 0 is outside its range, 1 to 100");
}

TEST(Parse, OldNamesAreRefusedWithTheNewOnes) {
  EXPECT_EQ(mistakes("[inequality]\nfriction_mu = 1\n[base_sensor]\nbus = 0\n",
                     {{"sqp.g_max=1"}, {"base_sensor.bus=0"}}),
            "robot.toml:2:1: friction_mu is now friction_barrier_weight; stilt config migrate robot.toml "
            "rewrites the file\n"
            "robot.toml:3:2: base_sensor is now torso_sensor; stilt config migrate robot.toml rewrites the "
            "file\n"
            "--set: sqp.g_max is now filter_violation_max\n"
            "--set: section base_sensor is now torso_sensor");
}

TEST(Write, WhatIsWrittenReadsBackBitForBit) {
  const unsigned seed = 71;
  std::mt19937_64 random(seed);
  for (int trial = 0; trial < 100; ++trial) {
    Parameters parameters;
    for (const Entry& entry : entries()) {
      if (const auto* real = std::get_if<RealField>(&entry.field)) {
        // Near the default, so that the values do not contradict each other.
        const double factor = std::uniform_real_distribution<double>(0.999, 1.0)(random);
        real->set(parameters, std::clamp(real->get(parameters) * factor, real->min, real->max));
      } else if (const auto* flag = std::get_if<FlagField>(&entry.field)) {
        // Not every protocol has CAN FD.
        flag->set(parameters, random() % 2 == 0 && !entry.name().ends_with(".can_fd"));
      } else if (const auto* choice = std::get_if<ChoiceField>(&entry.field)) {
        // Not every torso sensor goes with every protocol of the joints.
        std::size_t words = entry.name() == "torso_sensor.device" ? 1 : choice->words.size();
        if (entry.name().ends_with("_driver.protocol")) --words;  // ak_v3 has ranges of its own
        choice->set(parameters, static_cast<int>(random() % words));
      }
    }
    for (DriverParameters* driver : {&parameters.hardware.hip, &parameters.hardware.knee}) {
      driver->reply_torque_range_Nm = driver->torque_range_Nm;  // a Damiao has one range
      driver->kp_range_Nm_rad = DriverParameters{}.kp_range_Nm_rad;
      driver->kd_range_Nms_rad = DriverParameters{}.kd_range_Nms_rad;  // of its vendor
    }
    parameters.supervisor.track_gait |= parameters.supervisor.select_gait;
    const std::string text = to_toml(parameters, "Heading");
    const Result result = parse(text, "robot.toml");
    ASSERT_TRUE(result) << "seed " << seed << ", trial " << trial << ": " << to_string(result.error());
    for (const Entry& entry : entries()) {
      if (const auto* real = std::get_if<RealField>(&entry.field)) {
        EXPECT_EQ(real->get(*result), real->get(parameters)) << entry.name() << ", seed " << seed;
      } else {
        EXPECT_EQ(value_text(entry, *result), value_text(entry, parameters)) << entry.name();
      }
    }
  }
}

TEST(Load, AFileThatCannotBeReadIsNamed) {
  const Result missing = load_file("no/such/robot.toml");
  ASSERT_FALSE(missing);
  EXPECT_EQ(to_string(missing.error()),
            "no/such/robot.toml: cannot be read (No such file or directory); name a configuration file");
  const std::string folder = std::filesystem::temp_directory_path().string();
  const Result directory = load_file(folder);
  ASSERT_FALSE(directory);
  EXPECT_EQ(to_string(directory.error()),
            folder + ": cannot be read (Is a directory); name a configuration file");
}

TEST(Load, AFileIsReadLikeItsText) {
  const tests::OwnFolder folder;
  const std::string path = folder.file("robot.toml");
  std::ofstream(path) << "[gait]\nsingle_support_s = 0.35\n";
  const Result result = load_file(path);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_EQ(result->gait.single_support_s, 0.35);
}

TEST(Load, ARelativeUrdfIsFoundFromTheFolderOfTheFileThatNamesIt) {
  const tests::OwnFolder folder, elsewhere;
  const std::string path = folder.file("robot.toml");
  for (const std::string& urdf : {folder.file("mine.urdf"), elsewhere.file("mine.urdf")}) {
    std::filesystem::copy_file(STILT_TEST_DATA "/robots/heavy.urdf", urdf);
  }
  const auto robot_of = [&path](const std::string& robot, const std::vector<Override>& overrides = {}) {
    std::ofstream(path) << "[hardware]\nrobot = \"" << robot << "\"\n";
    const Result result = load_file(path, overrides);
    return result ? result->hardware.robot : to_string(result.error());
  };
  EXPECT_EQ(robot_of("mine.urdf"), folder.file("mine.urdf"));
  EXPECT_EQ(robot_of(elsewhere.file("mine.urdf")), elsewhere.file("mine.urdf"));
  EXPECT_EQ(robot_of("rabbit"), "rabbit");
  const std::string relative = std::filesystem::proximate(elsewhere.file("mine.urdf")).string();
  EXPECT_EQ(robot_of("mine.urdf", {{"hardware.robot=" + relative, "--robot"}}), relative);
}

TEST(Load, TheRobotIsTheOneThatIsNamedOrElseThatOfTheFile) {
  const tests::OwnFolder folder;
  const std::string named = folder.file("named.toml"), silent = folder.file("silent.toml");
  std::ofstream(named) << "[hardware]\nrobot = \"rabbit\"\n";
  std::ofstream(silent) << "[sqp]\niterations = 3\n";
  const auto robot_of = [](const std::string& file, std::string_view robot) {
    const Result result = load(file, robot, {});
    return result ? result->hardware.robot : to_string(result.error());
  };
  EXPECT_EQ(robot_of(named, ""), "rabbit");
  EXPECT_EQ(robot_of(named, "amber3m"), "amber3m");
  EXPECT_EQ(robot_of(silent, "rabbit"), "rabbit");
  EXPECT_EQ(robot_of(silent, ""), kDefaultRobot);
  EXPECT_EQ(robot_of("", ""), kDefaultRobot);
  EXPECT_EQ(robot_of("", "rabbit"), "rabbit");
  EXPECT_EQ(load(silent, "rabbit", {})->sqp.iterations, 3);
  EXPECT_NE(robot_of(named, "atlas").find("--robot"), std::string::npos);
}

TEST(Load, AFileNamesAUrdfSoThatItIsFoundAgain) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(robot_in_file("robot.toml", "mine.urdf"), "mine.urdf");
  EXPECT_EQ(robot_in_file("", "mine.urdf"), "mine.urdf") << "the working directory";
  EXPECT_EQ(robot_in_file(here + "/robots/robot.toml", "robots/mine.urdf"), "mine.urdf");
  EXPECT_EQ(robot_in_file("robot.toml", "robots/mine.urdf"), here + "/robots/mine.urdf");
  EXPECT_EQ(robot_in_file("robot.toml", "/robots/mine.urdf"), "/robots/mine.urdf");
  EXPECT_EQ(robot_in_file("robots/robot.toml", "rabbit"), "rabbit");
}

}  // namespace
}  // namespace stilt::configuration
