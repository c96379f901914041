#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <string>

#include "host_tools/simulation/plant/plant_options.h"
#include "mpc_core/model/types.h"

/// MuJoCo's model of robot and ground, with the plant's options applied.
namespace stilt::simulation {

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, DeleteModel>;
using DataPointer = std::unique_ptr<mjData, DeleteData>;

/// Indices of the robot's parts in MuJoCo's arrays. The generalised coordinates are those of the project: x,
/// z, pitch, hip_L, knee_L, hip_R, knee_R.
struct PhysicsIndices {
  int torso_body = 0;
  std::array<int, model::kFeet> foot_geom = {};
  std::array<int, model::kFeet> foot_site = {};
};

/// Compiles MJCF text. Throws std::runtime_error with MuJoCo's message when it does not compile. Throws it
/// too when the robot does not have the project's seven coordinates and two feet (geoms and sites foot_L,
/// foot_R).
[[nodiscard]] ModelPointer compile_mjcf(const std::string& mjcf, PhysicsIndices& indices);

/// Writes masses, armature, damping and friction of the joints to the model. Its MJCF already contains the
/// other options.
void apply_options(mjModel& physics, const PlantOptions& options);

}  // namespace stilt::simulation
