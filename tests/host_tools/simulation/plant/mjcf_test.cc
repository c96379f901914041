#include "host_tools/simulation/plant/mjcf.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "codegen/urdf/urdf_reader.h"

namespace stilt::simulation {
namespace {

/// AMBER-3M in a world of the given options.
class World {
 public:
  explicit World(const MjcfOptions& options) {
    const std::string text = to_mjcf(tree, options);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    char message[1000] = "";
    model.reset(mj_loadXML("robot.xml", files.get(), message, sizeof message));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(message);
    data.reset(mj_makeData(model.get()));
  }

  /// Straight legs, feet at the given height above z = 0 at x.
  void hang(double x_m, double foot_height_m) {
    mj_resetData(model.get(), data.get());
    data->qpos[0] = x_m;
    data->qpos[1] = 0.8731 + foot_height_m;
    mj_forward(model.get(), data.get());
  }

  /// Height of the ground below x, measured by a ray from 5 m above.
  double ground_m(double x_m) {
    hang(50.0, 50.0);
    const mjtNum from[3] = {x_m, 0.0, 5.0};
    const mjtNum down[3] = {0.0, 0.0, -1.0};
    int geom = -1;
    return 5.0 - mj_ray(model.get(), data.get(), from, down, nullptr, 1, -1, &geom);
  }

  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  codegen::PlanarTree tree = codegen::read_urdf(STILT_SOURCE_DIR "/codegen/robots/amber3m.urdf");
  std::unique_ptr<mjModel, Delete> model;
  std::unique_ptr<mjData, Delete> data;
};

TEST(MjcfTest, CoordinatesAndNamesAreThoseOfTheProject) {
  const World world({});
  ASSERT_EQ(world.model->nq, 7);
  const char* names[] = {"root_x", "root_z", "root_pitch", "hip_L", "knee_L", "hip_R", "knee_R"};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(mj_name2id(world.model.get(), mjOBJ_JOINT, names[i]), i);
  for (const char* name : {"hip", "torso_com", "foot_L", "foot_R"}) {
    EXPECT_GE(mj_name2id(world.model.get(), mjOBJ_SITE, name), 0) << name;
  }
  for (int i = 3; i < 7; ++i) EXPECT_EQ(mj_name2id(world.model.get(), mjOBJ_ACTUATOR, names[i]), i - 3);
  EXPECT_NEAR(mj_getTotalmass(world.model.get()), world.tree.mass_kg(), 1e-12);
}

TEST(MjcfTest, AVerticalLegTouchesTheGroundAtItsFootFrame) {
  World world({.foot_radius_m = 0.01});
  world.hang(0.0, 1e-6);
  EXPECT_EQ(world.data->ncon, 0);
  world.hang(0.0, -1e-6);
  EXPECT_EQ(world.data->ncon, 2);
}

TEST(MjcfTest, FeetTouchNothingButTheGround) {
  World world({});
  world.hang(0.0, 1.0);  // both feet at the same place in the air
  EXPECT_EQ(world.data->ncon, 0);
}

TEST(MjcfTest, WithoutContactsNothingTouches) {
  World world({.contacts = false});
  world.hang(0.0, -0.1);
  EXPECT_EQ(world.data->ncon, 0);
}

TEST(MjcfTest, TheGroundRisesWithThePositiveSlope) {
  World world({.ground_slope_rad = 0.1});
  for (const double x_m : {-3.0, 0.0, 2.5}) EXPECT_NEAR(world.ground_m(x_m), x_m * std::tan(0.1), 1e-9);
}

TEST(MjcfTest, StepsUpAndDownStandAtTheirPlaces) {
  World world({.steps = {{1.0, 0.05}, {2.0, -0.03}, {3.0, 0.02}}});
  EXPECT_NEAR(world.ground_m(0.5), 0.0, 1e-9);
  EXPECT_NEAR(world.ground_m(-20.0), 0.0, 1e-9);
  EXPECT_NEAR(world.ground_m(1.001), 0.05, 1e-9);
  EXPECT_NEAR(world.ground_m(1.999), 0.05, 1e-9);
  EXPECT_NEAR(world.ground_m(2.5), -0.03, 1e-9);
  EXPECT_NEAR(world.ground_m(60.0), 0.02, 1e-9);
}

TEST(MjcfTest, AStepOnASlopeAddsToIt) {
  World world({.ground_slope_rad = -0.05, .steps = {{1.0, 0.04}}});
  EXPECT_NEAR(world.ground_m(0.5), -0.5 * std::tan(0.05), 1e-9);
  EXPECT_NEAR(world.ground_m(4.0), -4.0 * std::tan(0.05) + 0.04, 1e-9);
}

TEST(MjcfTest, ArmatureAndStopsCanBeChosen) {
  const World plain({.armature = false});
  EXPECT_EQ(plain.model->dof_armature[3], 0.0);
  EXPECT_EQ(plain.model->jnt_limited[4], 0);
  const World limited({.joint_limits = true});
  EXPECT_NEAR(limited.model->dof_armature[3], 91.4286 * 91.4286 * 5.1e-5, 1e-12);
  EXPECT_EQ(limited.model->jnt_limited[4], 1);
  EXPECT_EQ(limited.model->jnt_range[2 * 4], 0.0);
}

}  // namespace
}  // namespace stilt::simulation
