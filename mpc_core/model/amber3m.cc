#include "codegen/generated/amber3m/constants.h"
#include "codegen/generated/amber3m/impact.h"
#include "codegen/generated/amber3m/kinematics.h"
#include "codegen/generated/amber3m/node.h"
#include "mpc_core/model/robot_binding.h"

namespace stilt::model {

const RobotModel& amber3m() noexcept {
  static constexpr RobotModel kModel = STILT_ROBOT_MODEL(generated::amber3m);
  return kModel;
}

}  // namespace stilt::model
