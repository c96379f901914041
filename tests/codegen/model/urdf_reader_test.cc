#include "codegen/model/urdf_reader.h"

#include <gtest/gtest.h>

#include <cmath>

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
    EXPECT_NEAR(link.joint.armature_kg_m2(), 0.426319, 1e-12);
  }
  ASSERT_EQ(tree.foot_count(), 2);
  EXPECT_EQ(tree.feet[0].name, "foot_L");
  EXPECT_EQ(tree.feet[1].name, "foot_R");
  EXPECT_NEAR(-tree.links[2].joint.origin_m.z - tree.feet[0].position_m.z, 0.8731, 1e-12);
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

}  // namespace
}  // namespace stilt::codegen
