#include "codegen/generated/rabbit/constants.h"
#include "codegen/generated/rabbit/impact.h"
#include "codegen/generated/rabbit/kinematics.h"
#include "codegen/generated/rabbit/node.h"
#include "mpc_core/model/robot_binding.h"

namespace stilt::model {

const RobotModel& rabbit() noexcept {
  static constexpr RobotModel kModel = STILT_ROBOT_MODEL(generated::rabbit);
  return kModel;
}

}  // namespace stilt::model
