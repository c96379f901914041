#include "codegen/generated/amber3m_2020/constants.h"
#include "codegen/generated/amber3m_2020/impact.h"
#include "codegen/generated/amber3m_2020/kinematics.h"
#include "codegen/generated/amber3m_2020/node.h"
#include "mpc_core/model/robot_binding.h"

namespace stilt::model {

const RobotModel& amber3m_2020() noexcept {
  static constexpr RobotModel kModel = STILT_ROBOT_MODEL(generated::amber3m_2020);
  return kModel;
}

}  // namespace stilt::model
