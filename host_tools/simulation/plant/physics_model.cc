#include "host_tools/simulation/plant/physics_model.h"

#include <cstring>
#include <stdexcept>

namespace stilt::simulation {
namespace {

constexpr char kFileName[] = "robot.xml";

int find(const mjModel& physics, int kind, const char* name) {
  const int id = mj_name2id(&physics, kind, name);
  if (id < 0) throw std::runtime_error(std::string("the simulated robot has no part named ") + name);
  return id;
}

}  // namespace

ModelPointer compile_mjcf(const std::string& mjcf, PhysicsIndices& indices) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), kFileName, static_cast<int>(mjcf.size()));
  std::memcpy(files->filedata[0], mjcf.data(), mjcf.size());
  char message[1000] = "";
  ModelPointer physics(mj_loadXML(kFileName, files.get(), message, sizeof message));
  mj_deleteVFS(files.get());
  if (!physics) throw std::runtime_error(std::string("MuJoCo refuses the robot: ") + message);
  if (physics->nq != model::kPositions || physics->nv != model::kPositions) {
    throw std::runtime_error("the simulated robot has " + std::to_string(physics->nq) +
                             " coordinates instead of 7");
  }
  indices.torso_body = physics->jnt_bodyid[model::kFirstAngle];
  indices.foot_geom = {find(*physics, mjOBJ_GEOM, "foot_L"), find(*physics, mjOBJ_GEOM, "foot_R")};
  indices.foot_site = {find(*physics, mjOBJ_SITE, "foot_L"), find(*physics, mjOBJ_SITE, "foot_R")};
  return physics;
}

void apply_options(mjModel& physics, const PlantOptions& options) {
  for (int body = 0; body < physics.nbody; ++body) {
    physics.body_mass[body] *= options.mass_scale;
    for (int axis = 0; axis < 3; ++axis) physics.body_inertia[3 * body + axis] *= options.mass_scale;
  }
  for (int dof = model::kFirstJoint; dof < model::kPositions; ++dof) {
    if (options.armature_kg_m2) physics.dof_armature[dof] = *options.armature_kg_m2;
    physics.dof_armature[dof] *= options.armature_scale;
    if (options.joint_damping_Nms_rad) physics.dof_damping[dof] = *options.joint_damping_Nms_rad;
    if (options.joint_friction_Nm) physics.dof_frictionloss[dof] = *options.joint_friction_Nm;
  }
  const DataPointer data(mj_makeData(&physics));
  mj_setConst(&physics, data.get());
}

}  // namespace stilt::simulation
