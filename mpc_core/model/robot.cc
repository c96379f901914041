#include "mpc_core/model/robot.h"

#include <string_view>

namespace stilt::model {

const RobotModel* find_robot(const char* name) noexcept {
  for (const RobotModel* robot : {&amber3m(), &amber3m_2020(), &rabbit()}) {
    if (std::string_view(robot->constants.name) == name) return robot;
  }
  return nullptr;
}

}  // namespace stilt::model
