#include "firmware/robots/robots.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "codegen/urdf/urdf_document.h"
#include "tests/own_folder.h"
#include "tests/robots.h"

namespace stilt::robots {
namespace {

const std::string kHeavyFile = STILT_TEST_DATA "/robots/heavy.urdf";

/// The URDF of a test robot with `from`, which must occur, replaced by `to`.
std::string changed(const std::string& from, const std::string& to, bool everywhere = false) {
  std::string text = codegen::read_text(kHeavyFile);
  std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("the description has no " + from);
  do {
    text.replace(at, from.size(), to);
    at = text.find(from, at + to.size());
  } while (everywhere && at != std::string::npos);
  return text;
}

std::string error_of(const std::string& urdf) {
  const auto robot = parse("robot.urdf", urdf);
  return robot ? "accepted" : robot.error();
}

class ShippedRobot : public testing::TestWithParam<const model::RobotModel*> {};

/// The numbers that tests without a URDF reader use are those of the URDF, and so are the coefficients to the
/// bit.
TEST_P(ShippedRobot, HasTheNumbersOfTheTests) {
  const model::RobotConstants& expected = GetParam()->constants;
  const auto robot = find(expected.name);
  ASSERT_TRUE(robot) << robot.error();
  const model::RobotConstants& found = (*robot)->model.constants;
  EXPECT_STREQ(found.name, expected.name);
  for (int i = 0; i < model::kNumbers; ++i)
    EXPECT_EQ(found.numbers[i], expected.numbers[i]) << "number " << i;
  for (int j = 0; j < model::kJoints; ++j) {
    EXPECT_EQ(found.position_min_rad[j], expected.position_min_rad[j]);
    EXPECT_EQ(found.position_max_rad[j], expected.position_max_rad[j]);
    EXPECT_EQ(found.velocity_limit_rad_s[j], expected.velocity_limit_rad_s[j]);
    EXPECT_EQ(found.torque_limit_Nm[j], expected.torque_limit_Nm[j]);
    EXPECT_EQ(found.joint_parameters[j], expected.joint_parameters[j]);
    EXPECT_EQ(found.joint_parameters[model::kJoints + j], expected.joint_parameters[model::kJoints + j]);
  }
  for (int i = 0; i < generated::five_link::kCoefficientCount; ++i) {
    EXPECT_EQ((*robot)->model.coefficients.coefficient[i], GetParam()->coefficients.coefficient[i])
        << "coefficient " << i;
  }
  EXPECT_EQ(found.total_mass_kg, (*robot)->tree.mass_kg());
}

INSTANTIATE_TEST_SUITE_P(Robots, ShippedRobot,
                         testing::Values(&testing_support::amber3m(), &testing_support::amber3m_2020(),
                                         &testing_support::rabbit()),
                         [](const auto& instance) { return std::string(instance.param->constants.name); });

TEST(Robots, AFileIsReadOnceAndKept) {
  const stilt::tests::OwnFolder folder;
  const std::string file = (folder.path() / "own.urdf").string();
  std::ofstream(file) << codegen::read_text(kHeavyFile);
  const auto robot = find(file);
  ASSERT_TRUE(robot) << robot.error();
  EXPECT_EQ((*robot)->name, file);
  EXPECT_EQ((*robot)->model.constants.name, file);
  EXPECT_NEAR((*robot)->model.constants.total_mass_kg, 15.5 + 2.0 * (3.4261 + 1.15), 1e-12);
  std::ofstream(file) << "";
  EXPECT_EQ(*find(file), *robot);
}

/// As a record carries it: the file may be gone, or another one by now.
TEST(Robots, AKeptRobotIsTheOneOfItsNameWhateverIsThere) {
  const stilt::tests::OwnFolder folder;
  const std::string file = folder.file("kept.urdf");
  const auto recorded = keep(file, codegen::read_text(kHeavyFile));
  ASSERT_TRUE(recorded) << recorded.error();
  EXPECT_EQ(*find(file), *recorded) << "there is no such file";
  EXPECT_EQ((*recorded)->model.constants.name, file);
  EXPECT_EQ(*keep(file, codegen::read_text(kHeavyFile)), *recorded) << "the same again";
  const auto other = keep(file, changed("<mass value=\"15.5\"/>", "<mass value=\"10\"/>"));
  ASSERT_TRUE(other) << other.error();
  EXPECT_EQ(*find(file), *other) << "the newest";
  EXPECT_NE((*other)->model.constants.total_mass_kg, (*recorded)->model.constants.total_mass_kg);
  EXPECT_FALSE(keep(file, "no URDF"));
  EXPECT_EQ(*find(file), *other);
}

TEST(Robots, AnUnknownNameAndAMissingFileAreRefusedInOneSentence) {
  EXPECT_EQ(find("asimo").error(),
            "there is no robot \"asimo\"; known robots are amber3m, amber3m_2020, rabbit; "
            "or give a file that ends in .urdf");
  EXPECT_EQ(find("/nowhere/own.urdf").error(),
            "/nowhere/own.urdf: cannot be read (No such file or directory); give the path of a URDF file");
}

TEST(Robots, AHipBesideTheTorsosOriginIsRefused) {
  const std::string hip = "<child link=\"thigh_R\"/>";
  EXPECT_EQ(
      error_of(changed(hip, hip + "<origin xyz=\"0.03 0 -0.02\"/>")),
      "robot.urdf: joint 'hip_R' stands at x 0.03 m, z -0.02 m of link 'torso'; both hips must stand at its "
      "origin: give them the origin 0 0 0 and move the frame of 'torso' there");
  EXPECT_EQ(error_of(changed(hip, hip + "<origin xyz=\"0 0.1 0\"/>")), "accepted") << "y is across the plane";
}

TEST(Robots, OtherNamesOfJointsAndLinksAreRefused) {
  EXPECT_EQ(error_of(changed("hip_L", "hip_left", true)),
            "robot.urdf: the joints are hip_R, knee_R, hip_left, knee_L; they must be hip_L, knee_L, hip_R, "
            "knee_R");
  EXPECT_EQ(
      error_of(changed("\"torso\"", "\"trunk\"", true)),
      "robot.urdf: there is trunk_mass_kg in place of torso_mass_kg; links must be torso, thigh_L, shin_L, "
      "thigh_R, shin_R");
}

TEST(Robots, TheOrderOfTheJointsInTheFileDoesNotMatter) {
  std::string text = codegen::read_text(kHeavyFile);
  const std::size_t left = text.find("<link name=\"thigh_L\">");
  const std::size_t right = text.find("<link name=\"thigh_R\">");
  const std::size_t end = text.find("</robot>");
  const std::string exchanged = text.substr(0, left) + text.substr(right, end - right) +
                                text.substr(left, right - left) + text.substr(end);
  const auto robot = parse("robot.urdf", exchanged);
  ASSERT_TRUE(robot) << robot.error();
  EXPECT_EQ(robot->tree.links[1].joint.name, "hip_L");
  EXPECT_EQ(robot->tree.feet[0].name, "foot_L");
}

TEST(Robots, AJointAboutMinusYIsRefused) {
  EXPECT_EQ(
      error_of(changed("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 -1 0\"/>")),
      "robot.urdf: joint 'hip_L' turns about -y; its axis must be 0 1 0, so that a positive angle swings the "
      "lower link backward");
}

/// Poses of the controller have no knee that bends the other way.
TEST(Robots, AKneeThatBendsForwardIsRefused) {
  const auto with_knees = [](const std::string& limits) {
    return error_of(changed("<limit lower=\"0\" upper=\"2.4\"", "<limit " + limits, true));
  };
  for (const char* limits : {"lower=\"-2.4\" upper=\"0\"", "lower=\"-2.4\" upper=\"-0.1\""}) {
    EXPECT_EQ(with_knees(limits),
              "robot.urdf: the upper limit of joint 'knee_L' must be above 0: knees bend to positive angles, "
              "which swing the shin backward");
  }
  EXPECT_EQ(with_knees("lower=\"-0.1\" upper=\"2.4\""), "accepted");
}

TEST(Robots, BentAndTurnedLinksAreRefused) {
  EXPECT_EQ(error_of(changed("<origin xyz=\"0 0 -0.4064\"/>", "<origin xyz=\"0.02 0 -0.4064\"/>")),
            "robot.urdf: joint 'knee_L' stands at x 0.02 m, z -0.4064 m of link 'thigh_L'; links must be "
            "straight: it "
            "must stand at x 0, below the link's own joint");
  EXPECT_EQ(
      error_of(changed("<origin xyz=\"0 0 -0.4064\"/>", "<origin xyz=\"0 0 -0.4064\" rpy=\"0 0.1 0\"/>")),
      "robot.urdf: joint 'knee_L' is turned by 0.1 rad against link 'thigh_L'; links must hang straight at "
      "zero "
      "angle: its origin must have rpy 0 0 0");
  EXPECT_EQ(error_of(changed("<origin xyz=\"0 0 -0.4667\"/>", "<origin xyz=\"0.05 0 -0.4667\"/>")),
            "robot.urdf: foot frame 'foot_L' stands at x 0.05 m, z -0.4667 m of link 'shin_L'; links must be "
            "straight: it must stand at x 0, below the link's own joint");
}

TEST(Robots, ACentreOfMassBesideTheLineOfTheJointsIsRefused) {
  EXPECT_EQ(error_of(changed("<origin xyz=\"0 0 0.21483\"/>", "<origin xyz=\"0.04 0 0.21483\"/>")),
            "robot.urdf: link 'torso' has its centre of mass at x 0.04 m; it must be on the line through its "
            "joints, "
            "x 0");
}

/// A guard or pad at the shin; listed before the foot, it gave the leg its length.
TEST(Robots, OnlyFootLAndFootRAreFeet) {
  std::string guarded = codegen::read_text(kHeavyFile);
  for (const std::string side : {"_L", "_R"}) {
    const std::string foot = "<link name=\"foot" + side + "\"/>";
    guarded.replace(guarded.find(foot), 0,
                    "<link name=\"foot_guard" + side + "\"/><joint name=\"guard" + side +
                        "\" type=\"fixed\"><parent link=\"shin" + side + "\"/><child link=\"foot_guard" +
                        side + "\"/><origin xyz=\"0 0 -0.3\"/></joint>");
  }
  const auto robot = parse("robot.urdf", guarded);
  ASSERT_TRUE(robot) << robot.error();
  const auto plain = parse("robot.urdf", codegen::read_text(kHeavyFile));
  for (int i = 0; i < model::kNumbers; ++i)
    EXPECT_EQ(robot->model.constants.numbers[i], plain->model.constants.numbers[i]) << "number " << i;
  EXPECT_EQ(robot->tree.foot_count(), 2);
  EXPECT_EQ(
      error_of(changed("foot_R", "foot_right", true)),
      "robot.urdf: link 'shin_R' ends a leg without a foot; add a massless link foot_L or foot_R to it");
}

TEST(Robots, AFootAtTheOtherLegIsRefused) {
  EXPECT_EQ(
      error_of(changed("<parent link=\"shin_R\"/>", "<parent link=\"shin_L\"/>")),
      "robot.urdf: foot frame 'foot_R' is fixed to link 'shin_L'; foot_L must end the left leg and foot_R "
      "the right one");
  const std::string left = "<child link=\"foot_L\"/>", right = "<child link=\"foot_R\"/>";
  std::string exchanged = codegen::read_text(kHeavyFile);
  exchanged.replace(exchanged.find(left), left.size(), right);
  exchanged.replace(exchanged.rfind(right), right.size(), left);
  EXPECT_EQ(
      error_of(exchanged),
      "robot.urdf: foot frame 'foot_L' is fixed to link 'shin_R'; foot_L must end the left leg and foot_R "
      "the right one");
}

TEST(Robots, LegsThatDifferAreRefused) {
  EXPECT_EQ(
      error_of(changed("<mass value=\"1.15\"/>", "<mass value=\"1.2\"/>")),
      "robot.urdf: shin_mass_kg is 1.2 for the left leg and 1.15 for the right one; both legs must be equal");
}

}  // namespace
}  // namespace stilt::robots
