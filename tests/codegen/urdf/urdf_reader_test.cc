#include "codegen/urdf/urdf_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "codegen/urdf/urdf_document.h"

namespace stilt::codegen {
namespace {

PlanarTree robot(const std::string& name) {
  return read_urdf(STILT_SOURCE_DIR "/codegen/robots/" + name + ".urdf");
}

TEST(UrdfReaderTest, Amber3mHasThePublishedNumbers) {
  const PlanarTree tree = robot("amber3m");
  EXPECT_NEAR(tree.mass_kg(), 21.5565, 1e-4);
  const double legs_kg = tree.mass_kg() - tree.links[0].mass_kg;
  EXPECT_NEAR(legs_kg / tree.mass_kg(), 0.397, 5e-4);
  ASSERT_EQ(tree.link_count(), 5);
  const char* joints[] = {"hip_L", "knee_L", "hip_R", "knee_R"};
  for (int j = 0; j < 4; ++j) {
    const PlanarLink& link = tree.links[static_cast<std::size_t>(j) + 1];
    EXPECT_EQ(link.joint.name, joints[j]);
    EXPECT_NEAR(link.joint.armature_kg_m2(), 0.426319, 5e-7);  // published to six digits
  }
  EXPECT_EQ(tree.links[0].com_m.z, 0.21483);
  ASSERT_EQ(tree.foot_count(), 2);
  EXPECT_EQ(tree.feet[0].name, "foot_L");
  EXPECT_EQ(tree.feet[1].name, "foot_R");
  EXPECT_NEAR(-tree.links[2].joint.origin_m.z - tree.feet[0].position_m.z, 0.8731, 1e-12);
}

TEST(UrdfReaderTest, TheAmber3mOf2020DiffersInTheTorsosCentreOfMassAlone) {
  const PlanarTree tree = robot("amber3m");
  const PlanarTree other = robot("amber3m_2020");
  EXPECT_EQ(other.links[0].com_m.z, 0.28507);
  ASSERT_EQ(other.link_count(), tree.link_count());
  for (std::size_t k = 0; k < tree.links.size(); ++k) {
    EXPECT_EQ(other.links[k].mass_kg, tree.links[k].mass_kg);
    EXPECT_EQ(other.links[k].inertia_kg_m2, tree.links[k].inertia_kg_m2);
    if (k == 0) continue;
    EXPECT_EQ(other.links[k].com_m.z, tree.links[k].com_m.z);
    EXPECT_EQ(other.links[k].joint.origin_m.z, tree.links[k].joint.origin_m.z);
    EXPECT_EQ(other.links[k].joint.armature_kg_m2(), tree.links[k].joint.armature_kg_m2());
    EXPECT_EQ(other.links[k].joint.torque_max_Nm, tree.links[k].joint.torque_max_Nm);
    EXPECT_EQ(other.links[k].joint.velocity_max_rad_s, tree.links[k].joint.velocity_max_rad_s);
  }
}

TEST(UrdfReaderTest, RabbitHasThePublishedNumbers) {
  const PlanarTree tree = robot("rabbit");
  EXPECT_DOUBLE_EQ(tree.mass_kg(), 32.0);
  for (int j = 1; j < tree.link_count(); ++j) {
    EXPECT_NEAR(tree.links[static_cast<std::size_t>(j)].joint.armature_kg_m2(), 0.83, 1e-12);
  }
}

TEST(UrdfReaderTest, LeftStandsBeforeRightWhateverTheDocumentsOrder) {
  const PlanarTree tree = read_urdf(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf");
  const char* joints[] = {"hip_L", "hip_R", "knee_R", "ankle_R", "tail_joint"};
  ASSERT_EQ(tree.joint_count(), 5);
  for (int j = 0; j < 5; ++j) EXPECT_EQ(tree.links[static_cast<std::size_t>(j) + 1].joint.name, joints[j]);
  EXPECT_EQ(tree.feet[0].name, "foot_L");
}

TEST(UrdfReaderTest, AFixedLinkMergesIntoTheLinkThatCarriesIt) {
  const PlanarLink torso = read_urdf(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf").links[0];
  EXPECT_DOUBLE_EQ(torso.mass_kg, 8.5);
  const double pack_x = -0.1 + 0.1 * std::sin(0.4);
  const double pack_z = 0.3 + 0.1 * std::cos(0.4);
  EXPECT_NEAR(torso.com_m.x, (7.0 * 0.03 + 1.5 * pack_x) / 8.5, 1e-15);
  EXPECT_NEAR(torso.com_m.z, (7.0 * 0.25 + 1.5 * pack_z) / 8.5, 1e-15);
  const double squared_distance = std::pow(pack_x - 0.03, 2) + std::pow(pack_z - 0.25, 2);
  EXPECT_NEAR(torso.inertia_kg_m2, 0.3 + 0.02 + 7.0 * 1.5 / 8.5 * squared_distance, 1e-14);
}

TEST(UrdfReaderTest, JointsKeepDirectionLossesAndLimits) {
  const PlanarTree tree = read_urdf(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf");
  EXPECT_EQ(tree.links[1].joint.direction, -1.0);
  EXPECT_DOUBLE_EQ(tree.links[1].joint.armature_kg_m2(), 0.2);
  EXPECT_EQ(tree.links[2].joint.direction, 1.0);
  EXPECT_NEAR(tree.links[2].joint.angle_offset_rad, 0.2, 1e-15);
  EXPECT_EQ(tree.links[2].joint.damping_Nm_s, 0.3);
  EXPECT_EQ(tree.links[2].joint.friction_Nm, 0.2);
  EXPECT_EQ(tree.links[2].joint.armature_kg_m2(), 0.0);
  EXPECT_EQ(tree.links[2].joint.torque_max_Nm, 60.0);
}

/// A body with a foot, its inertia given in a frame that is turned by `yaw_rad`.
std::string body_with_inertia(double yaw_rad) {
  return R"(<robot name="body"><link name="body"><inertial><origin xyz="0 0 0.2" rpy="0 0 )" +
         std::to_string(yaw_rad) +
         R"("/><mass value="5"/><inertia ixx="0.3" ixy="-0.04" ixz="0.01" iyy="0.2" iyz="0.02" izz="0.25"/>
            </inertial></link><link name="foot_L"/><joint name="sole" type="fixed"><parent link="body"/>
            <child link="foot_L"/></joint></robot>)";
}

TEST(UrdfReaderTest, InertiaIsThatAboutTheLateralAxisWhateverItsFrame) {
  for (const double yaw_rad : {0.0, 0.5, -1.25}) {
    const double s = std::sin(yaw_rad), c = std::cos(yaw_rad);
    // The lateral axis is (s, c, 0) in the frame of the inertia.
    const double expected = 0.3 * s * s + 2.0 * -0.04 * s * c + 0.2 * c * c;
    EXPECT_NEAR(parse_urdf(body_with_inertia(yaw_rad), "body").links[0].inertia_kg_m2, expected, 1e-12)
        << yaw_rad;
  }
}

std::string error_of(const std::string& urdf) {
  try {
    static_cast<void>(parse_urdf(urdf, "odd"));
  } catch (const UrdfError& error) {
    return error.what();
  }
  return "no error";
}

/// The odd tree with another text in place of one of its own.
std::string odd_tree_with(const std::string& from, const std::string& to) {
  std::string text = read_text(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of_odd_tree(const std::string& from, const std::string& to) {
  return error_of(odd_tree_with(from, to));
}

TEST(UrdfReaderTest, LossesThatDriveAndRangesThatAreEmptyAreRefused) {
  EXPECT_EQ(error_of_odd_tree("damping=\"0.3\"", "damping=\"0.3\""), "no error");
  const std::string losses =
      "odd: joint 'hip_R' has negative damping or friction; <dynamics> needs numbers that are not negative.";
  EXPECT_EQ(error_of_odd_tree("damping=\"0.3\"", "damping=\"-0.3\""), losses);
  EXPECT_EQ(error_of_odd_tree("friction=\"0.2\"", "friction=\"-0.2\""), losses);
  EXPECT_EQ(error_of_odd_tree("lower=\"-2\" upper=\"2\"", "lower=\"2\" upper=\"2\""),
            "odd: joint 'hip_R' has an empty range; <limit> needs lower below upper.");
}

TEST(UrdfReaderTest, AnAxisOfAnyLengthAlongYIsTakenAndNoOther) {
  const auto error_of_axis = [](const std::string& xyz) {
    return error_of_odd_tree("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"" + xyz + "\"/>");
  };
  for (const char* lateral : {"0 1 0", "0 2 0", "0 -0.5 0", "1e-10 1 0"}) {
    EXPECT_EQ(error_of_axis(lateral), "no error") << lateral;
  }
  for (const char* other : {"1 1 1", "0 1 0.7", "0.7 -1 0", "0 0 1", "0 0 0"}) {
    EXPECT_EQ(
        error_of_axis(other),
        "odd: not planar: joint 'hip_R' does not turn about the y axis; its axis must be 0 1 0 or 0 -1 0.")
        << other;
  }
}

TEST(UrdfReaderTest, AJointThatMimicsAnotherIsRefused) {
  EXPECT_EQ(
      error_of_odd_tree("<child link=\"shin_R\"/>", "<child link=\"shin_R\"/><mimic joint=\"hip_R\"/>"),
      "odd: joint 'knee_R' has <mimic>, which is not supported; each joint must have a motor of its own.");
}

constexpr const char* kReduction = "<mechanicalReduction>20</mechanicalReduction>";

TEST(UrdfReaderTest, TheGearRatioHasTheSpellingOfRos1OrOfRos2Control) {
  const std::string text = odd_tree_with(kReduction,
                                         "<hardwareInterface>EffortJointInterface</hardwareInterface>"
                                         "<mechanical_reduction>40</mechanical_reduction>");
  EXPECT_DOUBLE_EQ(parse_urdf(text, "odd").links[1].joint.armature_kg_m2(), 40.0 * 40.0 * 0.0005);
}

TEST(UrdfReaderTest, AnActuatorThatIsNotUnderstoodIsRefused) {
  EXPECT_EQ(error_of_odd_tree(kReduction, "<gearRatio>20</gearRatio>"),
            "odd: the <actuator> of joint 'hip_L' has <gearRatio>; it may have <mechanicalReduction>, "
            "<rotorInertia> and <hardwareInterface>.");
  EXPECT_EQ(error_of_odd_tree(kReduction, ""),
            "odd: the <actuator> of joint 'hip_L' has no <mechanicalReduction>; it needs the gear ratio, 1 "
            "without a gear.");
  EXPECT_EQ(error_of_odd_tree(kReduction, "<mechanicalReduction>0</mechanicalReduction>"),
            "odd: <mechanicalReduction> of joint 'hip_L' must be above zero.");
  for (const char* number : {"inf", "nan", "-20", "fast", ""}) {
    EXPECT_EQ(error_of_odd_tree("20</mechanicalReduction>", std::string(number) + "</mechanicalReduction>"),
              "odd: <mechanicalReduction> of joint 'hip_L' is '" + std::string(number) +
                  "'; it must be a number that is not negative.")
        << number;
  }
  EXPECT_EQ(error_of_odd_tree("<joint name=\"hip_R\"/>", "<joint name=\"hip_L\"/>"),
            "odd: joint 'hip_L' has two transmissions; it may have one.");
}

TEST(UrdfReaderTest, ANumberOfATransmissionIsReadToItsEnd) {
  for (const char* number : {"0,000051", "0.0005 kg", "5e-4,0", "1 2", "0x1p-4", "+-1"}) {
    EXPECT_EQ(error_of_odd_tree("0.0005</rotorInertia>", std::string(number) + "</rotorInertia>"),
              "odd: <rotorInertia> of joint 'hip_L' is '" + std::string(number) +
                  "'; it must be a number that is not negative.");
  }
  EXPECT_EQ(
      error_of_odd_tree("20</mechanicalReduction>", "50,5</mechanicalReduction>"),
      "odd: <mechanicalReduction> of joint 'hip_L' is '50,5'; it must be a number that is not negative.");
  for (const char* number : {" 5e-4 ", "\n\t0.0005\r\n", "+.0005"}) {
    const std::string text = odd_tree_with("0.0005</rotorInertia>", std::string(number) + "</rotorInertia>");
    EXPECT_DOUBLE_EQ(parse_urdf(text, "odd").links[1].joint.armature_kg_m2(), 0.2) << number;
  }
}

TEST(UrdfReaderTest, ATransmissionOfRos2ControlIsRead) {
  const auto armature = [](const std::string& text) {
    return parse_urdf(text, "odd").links[1].joint.armature_kg_m2();
  };
  std::string text =
      odd_tree_with("  <transmission", "<ros2_control name=\"a\" type=\"system\"><transmission");
  text.replace(text.find("</transmission>"), 15, "</transmission></ros2_control>");
  EXPECT_DOUBLE_EQ(armature(text), 0.2) << "the first of the joints alone";
  text.replace(text.find("</ros2_control>"), 15, "</ros2_control><ros2_control name=\"b\" type=\"system\">");
  text.replace(text.find("</robot>"), 8, "</ros2_control></robot>");
  EXPECT_DOUBLE_EQ(armature(text), 0.2) << "the others in a second one";
  text.replace(text.find("<joint name=\"hip_R\"/>"), 21, "<joint name=\"hip_L\"/>");
  EXPECT_EQ(error_of(text), "odd: joint 'hip_L' has two transmissions; it may have one.");
}

TEST(UrdfReaderTest, TheGearRatioIsThatOfTheTransmissionsJointOrOfItsActuator) {
  std::string text = odd_tree_with(kReduction, "");
  const std::string joint = "<joint name=\"hip_L\"/>";
  const std::string with_ratio =
      "<joint name=\"hip_L\" role=\"joint1\"><hardwareInterface>EffortJointInterface</hardwareInterface>"
      "<mechanical_reduction>40</mechanical_reduction><offset>0.5</offset></joint>";
  text.replace(text.find(joint), joint.size(), with_ratio);
  EXPECT_DOUBLE_EQ(parse_urdf(text, "odd").links[1].joint.armature_kg_m2(), 40.0 * 40.0 * 0.0005);
  EXPECT_EQ(error_of_odd_tree(joint, with_ratio),
            "odd: the transmission of joint 'hip_L' has two gear ratios; it may have one.");
  EXPECT_EQ(error_of_odd_tree(joint, "<joint name=\"hip_L\"><rotorInertia>1</rotorInertia></joint>"),
            "odd: the <joint> of the transmission of joint 'hip_L' has <rotorInertia>; it may have "
            "<mechanicalReduction>, <offset> and <hardwareInterface>.");
}

TEST(UrdfReaderTest, ATransmissionHasOneActuatorAndOneJoint) {
  EXPECT_EQ(
      error_of_odd_tree("</actuator>", "</actuator><actuator name=\"second\"/>"),
      "odd: the transmission of joint 'hip_L' has two <actuator>; a joint has one motor, and a motor one "
      "joint.");
  EXPECT_EQ(error_of_odd_tree("</actuator>", "</actuator><joint name=\"hip_R\"/>"),
            "odd: the transmission of joint 'hip_L' has two <joint>; a joint has one motor, and a motor one "
            "joint.");
}

TEST(UrdfReaderTest, ARotorInertiaIsStatedForAllJointsOrForNone) {
  EXPECT_EQ(error_of_odd_tree("<rotorInertia>0.0005</rotorInertia>", ""),
            "odd: joint 'hip_L' has no <rotorInertia> in a transmission, and joint 'hip_R' has one; give all "
            "joints one, 0 where it is negligible.");
  const std::string text = read_text(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf");
  const std::size_t first = text.find("  <transmission");
  const std::size_t second = text.find("  <transmission", first + 1);
  const std::size_t end = text.find("</robot>");
  EXPECT_EQ(error_of(text.substr(0, first) + text.substr(second)),
            "odd: joint 'hip_L' has no <rotorInertia> in a transmission, and joint 'hip_R' has one; give all "
            "joints one, 0 where it is negligible.")
      << "a transmission is missing";
  EXPECT_EQ(error_of(text.substr(0, first) + text.substr(end)), "no error") << "all are";
}

}  // namespace
}  // namespace stilt::codegen
