#include <gtest/gtest.h>

#include <string>

#include "host_tools/simulation/plant/plant.h"
#include "host_tools/simulation/plant/plant_options.h"
#include "tests/host_tools/simulation/plant/test_robots.h"

namespace stilt::simulation {
namespace {

constexpr const char* kLinks[] = {"torso", "thigh_L", "shin_L", "thigh_R", "shin_R"};

/// The engine's model of AMBER-3M after assignments of --plant.
ModelPointer physics_of(std::initializer_list<std::string> assignments) {
  PlantOptions options;
  for (const std::string& assignment : assignments) set_plant_option(options, assignment);
  PhysicsIndices index;
  ModelPointer physics =
      compile_mjcf(make_plant_model(robot_tree("amber3m"), options, kHipHeight_m).mjcf, index);
  apply_options(*physics, options);
  return physics;
}

struct Inertial {
  double mass_kg, inertia_kg_m2, com_x_m, com_z_m;
};

Inertial inertial(const mjModel& physics, const char* link) {
  const int body = mj_name2id(&physics, mjOBJ_BODY, link);
  return {physics.body_mass[body], physics.body_inertia[3 * body], physics.body_ipos[3 * body],
          physics.body_ipos[3 * body + 2]};
}

TEST(PlantLinks, EachKeyChangesItsLinkAndNoOther) {
  const ModelPointer usual = physics_of({});
  for (const char* changed : kLinks) {
    const std::string key = changed;
    const ModelPointer physics = physics_of(
        {key + "_mass_scale=1.1", key + "_inertia_scale=0.9", key + "_com_x_m=0.01", key + "_com_z_m=-0.02"});
    for (const char* link : kLinks) {
      const Inertial before = inertial(*usual, link), after = inertial(*physics, link);
      const bool same = std::string(link) != changed;
      EXPECT_NEAR(after.mass_kg / before.mass_kg, same ? 1.0 : 1.1, 1e-12) << changed << " " << link;
      EXPECT_NEAR(after.inertia_kg_m2 / before.inertia_kg_m2, same ? 1.0 : 0.9, 1e-12)
          << changed << " " << link;
      EXPECT_NEAR(after.com_x_m - before.com_x_m, same ? 0.0 : 0.01, 1e-12) << changed << " " << link;
      EXPECT_NEAR(after.com_z_m - before.com_z_m, same ? 0.0 : -0.02, 1e-12) << changed << " " << link;
    }
  }
}

TEST(PlantLinks, ForwardIsForwardAndUpIsUpOfAnUprightRobot) {
  PlantOptions options;
  set_plant_option(options, "torso_com_x_m=0.01");
  set_plant_option(options, "torso_com_m=0.285");
  set_plant_option(options, "torso_com_z_m=0.02");
  Plant plant = amber_plant(options);
  plant.set_state(model::StateVector::Zero());
  EXPECT_NEAR(plant.torso_com_m().x(), 0.01, 1e-12);
  EXPECT_NEAR(plant.torso_com_m().y(), 0.305, 1e-12) << "the shift counts from the chosen height";
}

TEST(PlantLinks, FactorsOfALinkAndOfAllMultiply) {
  const ModelPointer usual = physics_of({}), both = physics_of({"mass_scale=1.2", "shin_R_mass_scale=1.1"});
  EXPECT_NEAR(inertial(*both, "shin_R").mass_kg, 1.32 * inertial(*usual, "shin_R").mass_kg, 1e-12);
  EXPECT_NEAR(inertial(*both, "shin_L").mass_kg, 1.2 * inertial(*usual, "shin_L").mass_kg, 1e-12);
}

TEST(PlantLinks, ArmatureIsScaledThatOfTheUrdfAndThatOfTheOption) {
  const ModelPointer usual = physics_of({}), scaled = physics_of({"armature_scale=0.75"}),
                     own = physics_of({"armature=0.2", "armature_scale=0.5"});
  for (int dof = 0; dof < model::kPositions; ++dof) {
    EXPECT_NEAR(scaled->dof_armature[dof], 0.75 * usual->dof_armature[dof], 1e-15);
    EXPECT_NEAR(own->dof_armature[dof], dof < model::kFirstJoint ? 0.0 : 0.1, 1e-15);
  }
}

TEST(PlantLinks, TorqueLimitIsScaledThatOfTheUrdfAndThatOfTheOption) {
  PlantOptions options;
  set_plant_option(options, "torque_limit_scale=0.8");
  EXPECT_EQ(amber_plant(options).torque_limit_Nm(), model::JointVector::Constant(64.0));
  set_plant_option(options, "torque_limit_Nm=50");
  EXPECT_EQ(amber_plant(options).torque_limit_Nm(), model::JointVector::Constant(40.0));
}

}  // namespace
}  // namespace stilt::simulation
