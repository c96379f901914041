#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/host_tools/program_test.h"

namespace stilt::cli {
namespace {

using testing_support::Outcome;
using testing_support::text_of;

class GaitCommand : public testing_support::ProgramTest {
 protected:
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return ProgramTest::run("gait " + arguments);
  }
};

const std::string kShipped = STILT_GAITS "/amber3m_0.50.toml";

TEST_F(GaitCommand, CheckWritesTheFieldsOfTheContract) {
  const Outcome outcome = run("check " + kShipped + " --json");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json.at("valid"), true);
  EXPECT_EQ(json.at("speed_m_s"), 0.5);
  for (const char* field : {"step_time_s", "step_length_m", "defect_max", "periodicity_error",
                            "return_map_spectral_radius", "friction_ratio_max", "clearance_m"}) {
    EXPECT_TRUE(json.at(field).is_number()) << field;
  }
  EXPECT_EQ(json.at("peak_torque_Nm").size(), 4u);
  EXPECT_TRUE(json.at("violations").empty());
}

TEST_F(GaitCommand, CheckOfAGaitThatBreaksItsLimitsIsStatusOneAndNamesThem) {
  std::string text = text_of(kShipped);
  const std::string limit = "torque_Nm = 60.0";
  const std::size_t at = text.find(limit);
  ASSERT_NE(at, std::string::npos);
  std::ofstream(file("weak.toml")) << text.replace(at, limit.size(), "torque_Nm = 20.0");
  const Outcome outcome = run("check " + file("weak.toml") + " --json");
  EXPECT_EQ(outcome.status, 1);
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json.at("valid"), false);
  EXPECT_EQ(json.at("violations"), nlohmann::json({"torque_Nm"}));
  const auto& violated = json.at("violated_bounds").at(0);
  EXPECT_EQ(violated.at("name"), "torque_Nm");
  EXPECT_EQ(violated.at("kind"), "at most");
  EXPECT_EQ(violated.at("bound"), 20.0);
  EXPECT_GT(violated.at("value"), 20.0);
  const std::string printed = run("check " + file("weak.toml")).output;
  EXPECT_NE(printed.find("\n  not valid:\n    torque_Nm "), std::string::npos) << printed;
  EXPECT_NE(printed.find(", at most 20\n"), std::string::npos) << printed;
}

TEST_F(GaitCommand, AUrdfIsNamedFromTheFolderOfTheGaitFile) {
  std::filesystem::copy_file(STILT_URDF, file("mine.urdf"));
  std::string text = text_of(kShipped);
  const std::string name = "\"amber3m\"";
  std::ofstream(file("gait.toml")) << text.replace(text.find(name), name.size(), "\"mine.urdf\"");
  const auto robot_of = [](const std::string& gait) {
    const std::string written = text_of(gait);
    const std::size_t at = written.find("robot = ");
    return written.substr(at, written.find('\n', at) - at);
  };
  const auto relative = [this](const char* named) { return std::filesystem::relative(file(named)).string(); };
  std::filesystem::create_directory(file("below"));
  ASSERT_EQ(run("complete " + relative("gait.toml") + " --out " + relative("beside.toml")).status, 0);
  EXPECT_EQ(robot_of(file("beside.toml")), "robot = \"mine.urdf\"");
  ASSERT_EQ(run("complete " + relative("beside.toml") + " --out " + relative("below/gait.toml")).status, 0);
  EXPECT_TRUE(robot_of(file("below/gait.toml")).starts_with("robot = \"/"));
  EXPECT_EQ(run("check " + file("below/gait.toml")).status, 0);
}

TEST_F(GaitCommand, ARobotWithUnequalLegsIsRefused) {
  std::string urdf = text_of(STILT_URDF);
  const std::string inertia = "<rotorInertia>5.1e-5</rotorInertia>";
  const std::size_t last = urdf.rfind(inertia);
  ASSERT_NE(last, std::string::npos);
  std::ofstream(file("mine.urdf")) << urdf.replace(last, inertia.size(), "<rotorInertia>6e-5</rotorInertia>");
  std::string text = text_of(kShipped);
  const std::string name = "\"amber3m\"";
  std::ofstream(file("gait.toml")) << text.replace(text.find(name), name.size(), "\"mine.urdf\"");
  const std::string robot = "--robot " + file("mine.urdf");
  for (const std::string& arguments :
       {"synthesize --speed 0.5 " + robot + " --out " + file("x"), "library " + robot + " --out " + file("y"),
        "check " + file("gait.toml")}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_NE(
        outcome.errors.find("mine.urdf: knee_L and knee_R have different armature; gaits are for robots "
                            "with equal legs\n"),
        std::string::npos)
        << outcome.errors;
  }
}

TEST_F(GaitCommand, SynthesizesChecksAndShowsAGait) {
  ASSERT_EQ(run("synthesize --speed 0.35 --out " + file("a.toml")).status, 0);
  EXPECT_EQ(run("check " + file("a.toml")).status, 0);
  EXPECT_EQ(run("show " + file("a.toml") + " --report " + file("a.html")).status, 0);
  EXPECT_NE(text_of(file("a.html")).find("<svg"), std::string::npos);
}

TEST_F(GaitCommand, AGaitThatIsTooRoughForTheSearchIsSaidToBe) {
  std::string urdf = text_of(STILT_URDF);
  const std::string inertia = "<rotorInertia>5.1e-5</rotorInertia>";
  for (std::size_t at = 0; (at = urdf.find(inertia)) != std::string::npos;) {
    urdf.replace(at, inertia.size(), "<rotorInertia>6e-6</rotorInertia>");  // 0.05 kg m^2 at the joint
  }
  std::ofstream(file("mine.urdf")) << urdf;
  const std::string robot = "--robot " + file("mine.urdf") + " --out " + file("gait.toml");
  const Outcome rough = run("synthesize --speed 0.2 " + robot);
  EXPECT_EQ(rough.status, 1);
  EXPECT_NE(rough.errors.find("stilt: accuracy of this search, no limits of yours: periodicity"),
            std::string::npos)
      << rough.errors;
  const Outcome smooth = run("synthesize --speed 0.2 --cost acceleration --degree 5 " + robot);
  EXPECT_EQ(smooth.status, 0) << smooth.output;
  EXPECT_EQ(smooth.errors.find("accuracy"), std::string::npos) << smooth.errors;
}

TEST_F(GaitCommand, MakesALibraryWithOneFilePerSpeed) {
  ASSERT_EQ(run("library --from -0.1 --to 0.1 --step 0.1 --out " + file("library")).status, 0);
  for (const char* name : {"amber3m_-0.10.toml", "amber3m_0.00.toml", "amber3m_0.10.toml"}) {
    EXPECT_EQ(run("check " + file("library") + "/" + name).status, 0) << name;
  }
}

TEST_F(GaitCommand, SpeedsThatDifferInTheThirdDecimalHaveFilesOfTheirOwn) {
  ASSERT_EQ(run("library --from 0.115 --to 0.125 --step 0.01 --out " + file("library")).status, 0);
  for (const char* name : {"amber3m_0.115.toml", "amber3m_0.125.toml"}) {
    EXPECT_TRUE(std::filesystem::exists(file("library") + "/" + name)) << name;
  }
}

TEST_F(GaitCommand, ALibraryOfMoreGaitsThanCanBeLoadedIsRefusedBeforeAnyWork) {
  for (const auto& [range, sentence] :
       {std::pair{"--from -0.4 --to 1 --step 0.02",
                  "--step 0.02: gives 71 gaits, and a library holds at most 32; take at least --step 0.044"},
        {"--from 0 --to 0.32 --step 0.01",
         "--step 0.01: gives 33 gaits, and a library holds at most 32; take at least --step 0.011"}}) {
    const Outcome outcome = run(std::string("library ") + range + " --out " + file("library"));
    EXPECT_EQ(outcome.status, 2) << range;
    EXPECT_EQ(outcome.errors, std::string("stilt: ") + sentence + "\n");
    EXPECT_FALSE(std::filesystem::exists(file("library"))) << range;
  }
  const Outcome most = run("library --from 0 --to 0.31 --step 0.01 --phase hip --out " + file("library"));
  EXPECT_EQ(most.errors.find("--step"), std::string::npos) << "32 are not too many: " << most.errors;
}

TEST_F(GaitCommand, ALibraryGoesOnAfterASpeedWithoutAGait) {
  const Outcome outcome = run("library --from 0.1 --to 0.2 --limit knee_min_rad=3 --out " + file("library") +
                              " --json " + file("json"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.errors.find("no gait at 0.2 m/s"), std::string::npos) << outcome.errors;
  const auto rows = nlohmann::json::parse(text_of(file("json"))).at("gaits");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("speed_m_s"), 0.1);
  EXPECT_EQ(rows[0].at("valid"), false);
  EXPECT_NE(rows[1].at("error").get<std::string>().find("no gait at 0.2 m/s"), std::string::npos);
}

TEST_F(GaitCommand, AnOutputThatCannotBeWrittenKeepsNoOtherBack) {
  const Outcome outcome = run("show " + kShipped + " --report /dev/full --json " + file("json"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(nlohmann::json::parse(text_of(file("json"))).at("valid"), true);
}

TEST_F(GaitCommand, CompletesAGaitFromElsewhere) {
  for (const char* shipped : {"/amber3m_0.50.toml", "/amber3m_0.10.toml"}) {  // along the hip, and the time
    const std::string text = text_of(std::string(STILT_GAITS) + shipped);
    const std::size_t outputs = text.find("[outputs]");
    const std::size_t feedback = text.find("[feedback]");
    std::ofstream(file("bare.toml")) << "format = 1\nrobot = \"amber3m\"\n"
                                     << text.substr(outputs, feedback - outputs);
    const Outcome outcome = run("complete " + file("bare.toml") + " --out " + file("full.toml"));
    ASSERT_EQ(outcome.status, 0) << shipped << ": " << outcome.output << outcome.errors;
    EXPECT_EQ(run("check " + file("full.toml")).status, 0) << shipped;
  }
}

TEST_F(GaitCommand, AGaitFromElsewhereWithoutAMotionIsRefusedWithTheMistakeThatWasMade) {
  const std::string text = text_of(kShipped);
  const std::size_t outputs = text.find("[outputs]");
  std::string bare =
      "format = 1\nrobot = \"amber3m\"\n" + text.substr(outputs, text.find("[feedback]") - outputs);
  for (const auto& [from, to] : {std::pair{"stance_", "?"}, {"swing_", "stance_"}, {"?", "swing_"}}) {
    for (std::size_t at = 0; (at = bare.find(from)) != std::string::npos;)
      bare.replace(at, std::strlen(from), to);
  }
  std::ofstream(file("swapped.toml")) << bare;
  const Outcome outcome = run("check " + file("swapped.toml"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(
      outcome.errors.find("swapped.toml: the outputs give no periodic motion; there is one when stance and "
                          "swing leg are exchanged (docs/gaits.md)\n"),
      std::string::npos)
      << outcome.errors;
}

TEST_F(GaitCommand, BadInputIsOneSentenceAndStatusTwo) {
  const std::vector<std::string> mistakes = {
      "",
      "check /nowhere.toml",
      "synthesize --speed 0.5",
      "synthesize --speed 9 --out " + file("x"),
      "synthesize --speed 0 --phase hip --out " + file("x"),
      "synthesize --speed 0.5 --cost joy --out " + file("x"),
      "synthesize --speed 0.5 --limit torque=3 --out " + file("x"),
      "synthesize --speed 0.5 --out /nowhere/at/all.toml",
      "synthesize --robot nonsense --speed 0.5 --out " + file("x"),
      "library --from 1 --to 0 --out " + file("x"),
      "check " + kShipped + " --json /nowhere/x.json",
      "library --from 0.1 --to 0.1 --json /nowhere/x.json --out " + file("x"),
      "library --from -0.1 --to 0.1 --phase hip --out " + file("x"),
  };
  for (const std::string& arguments : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1)
        << arguments << outcome.errors;
  }
}

TEST_F(GaitCommand, SaysSoWithStatusOneWhenThereIsNoGait) {
  const Outcome outcome = run("synthesize --speed 0.5 --limit knee_min_rad=3 --out " + file("x"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.errors.find("no gait at 0.5 m/s: the limits contradict"), std::string::npos)
      << outcome.errors;
  EXPECT_FALSE(std::filesystem::exists(file("x")));
}

}  // namespace
}  // namespace stilt::cli
