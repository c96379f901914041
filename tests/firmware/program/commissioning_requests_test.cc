#include "firmware/program/commissioning_requests.h"

#include <gtest/gtest.h>

#include "firmware/robots/robots.h"

namespace stilt::program {
namespace {

TEST(CommissioningRequests, TheSmallerTorqueShareCounts) {
  const model::RobotModel& robot = (*robots::find("amber3m"))->model;
  Options options;
  options.identify_torque_share = 0.3;
  EXPECT_EQ(jog_request(options, robot).torque_share, commissioning::kJogTorqueShare);
  EXPECT_EQ(identification_request(options, robot).torque_share, 0.3);
  options.configuration.supervisor.torque_limit_share = 0.1;
  EXPECT_EQ(jog_request(options, robot).torque_share, 0.1);
  EXPECT_EQ(identification_request(options, robot).torque_share, 0.1);
  EXPECT_EQ(jog_request(options, robot).torque_limit_Nm, 80.0);
  EXPECT_NEAR(jog_request(options, robot).push_Nm, 2.913 + 1, 0.001)
      << "of the leg's gravity, and for friction";
  options.joint = 1;
  EXPECT_NEAR(jog_request(options, robot).push_Nm, 0.425 + 1, 0.001) << "of the shin's";
}

TEST(CommissioningRequests, TheSupervisorsBoundsOfEncodersCount) {
  const model::RobotModel& robot = (*robots::find("amber3m"))->model;
  Options options;
  options.configuration.supervisor.unchanged_replies_limit = 70;
  EXPECT_EQ(jog_request(options, robot).supervisor.unchanged_replies_limit, 70);
  EXPECT_EQ(identification_request(options, robot).supervisor.unchanged_replies_limit, 70);
}

TEST(CommissioningRequests, TheSupervisorsLimitsOfDriversAndOfTheLoopCount) {
  Options options;
  options.configuration.supervisor.overheated_C = 81;
  options.configuration.supervisor.low_voltage_V = 22;
  options.configuration.supervisor.high_voltage_V = 33;
  options.configuration.supervisor.torque_loop_stall_s = 0.02;
  const commissioning::DriverLimits limits = driver_limits(options);
  EXPECT_EQ(limits.overheated_C, 81);
  EXPECT_EQ(limits.low_voltage_V, 22);
  EXPECT_EQ(limits.high_voltage_V, 33);
  EXPECT_EQ(limits.stall_s, 0.02);
}

}  // namespace
}  // namespace stilt::program
