#include "firmware/commissioning/unknown_turns.h"

#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {

std::string unknown_turns(const hal::RobotHardware& hardware) {
  std::string joints;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (hardware.turn_known(joint)) continue;
    joints += (joints.empty() ? "" : ", ") + std::string(control_loop::kJointNames[joint]);
  }
  if (joints.empty()) return "";
  return joints + ": the angle may be wrong by whole turns of the rotor, whose encoder the driver has alone";
}

}  // namespace stilt::commissioning
