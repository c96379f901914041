#include "hal/gain_ramp.h"

#include <gtest/gtest.h>

namespace stilt::hal {
namespace {

JointReadings measured() {
  JointReadings readings;
  for (std::size_t joint = 0; joint < kJoints; ++joint)
    readings[joint].position_rad = 0.1 * static_cast<double>(joint);
  return readings;
}

JointCommands wanted() {
  JointCommands commands;
  commands.fill({.position_rad = 1, .velocity_rad_s = 2, .torque_Nm = 3, .kp_Nm_rad = 40, .kd_Nms_rad = 5});
  return commands;
}

TEST(GainRamp, StartsAtTheMeasuredPoseWithoutGains) {
  GainRamp ramp;
  ramp.start(1000, 100, measured());
  const JointCommands commands = ramp.ramped(1000, wanted());
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    EXPECT_EQ(commands[joint].position_rad, measured()[joint].position_rad);
    EXPECT_EQ(commands[joint].kp_Nm_rad, 0);
    EXPECT_EQ(commands[joint].kd_Nms_rad, 0);
    EXPECT_EQ(commands[joint].torque_Nm, 0);
  }
}

TEST(GainRamp, EndsWithWhatIsWantedAndStaysThere) {
  GainRamp ramp;
  ramp.start(1000, 100, measured());
  for (const std::int64_t now_ns : {1100, 5000}) {
    const JointCommands commands = ramp.ramped(now_ns, wanted());
    EXPECT_EQ(commands[3].position_rad, 1);
    EXPECT_EQ(commands[3].kp_Nm_rad, 40);
    EXPECT_EQ(commands[3].torque_Nm, 3);
  }
  EXPECT_EQ(ramp.fraction(0), 0) << "a time before the start is the start";
}

TEST(GainRamp, TheTorqueAtTheMeasuredPoseGrowsWithoutAJump) {
  GainRamp ramp;
  ramp.start(0, 1000, measured());
  double last_Nm = 0;
  for (std::int64_t now_ns = 0; now_ns <= 1000; ++now_ns) {
    const JointCommand command = ramp.ramped(now_ns, wanted())[1];
    const double torque_Nm = command.torque_Nm + command.kp_Nm_rad * (command.position_rad - 0.1) +
                             command.kd_Nms_rad * command.velocity_rad_s;
    EXPECT_LE(std::abs(torque_Nm - last_Nm), 0.11);
    last_Nm = torque_Nm;
  }
}

}  // namespace
}  // namespace stilt::hal
