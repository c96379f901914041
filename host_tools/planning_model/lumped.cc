#include "host_tools/planning_model/lumped.h"

#include "codegen/generated/amber3m_lumped/constants.h"
#include "codegen/generated/amber3m_lumped/impact.h"
#include "codegen/generated/amber3m_lumped/kinematics.h"
#include "codegen/generated/amber3m_lumped/node.h"
#include "mpc_core/model/robot_binding.h"

namespace stilt::planning_model {
namespace {

// The names that STILT_ROBOT_MODEL uses.
using model::Batch;
using model::BiasTerms;
using model::FlowDerivatives;
using model::FlowTerms;
using model::ImpactDerivatives;
using model::ImpactTerms;
using model::KinematicsTerms;
using model::MassMatrixTerms;
using model::NodeDerivatives;
using model::NodeTerms;
using model::RobotConstants;
using model::RobotFunctions;
using model::RobotModel;

RobotModel without_drives(RobotModel model) noexcept {
  for (int j = 0; j < model::kJoints; ++j) model.constants.joint_parameters[j] = 0.0;
  return model;
}

}  // namespace

const RobotModel* lumped(std::string_view robot, Lump lump) noexcept {
  static constexpr RobotModel kLegs = STILT_ROBOT_MODEL(generated::amber3m_lumped);
  static const RobotModel kDrives = without_drives(kLegs);
  if (robot != "amber3m") return nullptr;
  return lump == Lump::legs ? &kLegs : &kDrives;
}

}  // namespace stilt::planning_model
