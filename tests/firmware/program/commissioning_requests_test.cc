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
}

}  // namespace
}  // namespace stilt::program
