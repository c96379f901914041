#include "hal/robot/robot_wiring.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "tests/hal/robot/emulated_robot.h"

namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::Robot;

TEST(RobotWiring, EachThingWithoutSenseIsRefusedByItself) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const RobotWiring good = Robot(Kind::moteus).wiring_;
  ASSERT_TRUE(valid(good, 2));
  const std::vector<std::pair<const char*, std::function<void(RobotWiring&)>>> faults{
      {"too many channels", [](RobotWiring& w) { w.channel_count = kMaximumChannels + 1; }},
      {"sensor on a bus that does not exist", [](RobotWiring& w) { w.channel_bus = 2; }},
      {"torso encoder at a joint that does not exist", [](RobotWiring& w) { w.pitch_encoder_joint = 4; }},
      {"joint on a bus that does not exist", [](RobotWiring& w) { w.joints[3].bus = 2; }},
      {"half a direction", [](RobotWiring& w) { w.joints[0].direction = 0.5; }},
      {"no ratio", [](RobotWiring& w) { w.joints[0].ratio = 0; }},
      {"no torque factor", [](RobotWiring& w) { w.joints[1].torque_factor = 0; }},
      {"endless torque factor", [kInfinity](RobotWiring& w) { w.joints[1].torque_factor = kInfinity; }},
      {"negative ratio", [](RobotWiring& w) { w.joints[0].ratio = -2; }},
      {"endless ratio", [kInfinity](RobotWiring& w) { w.joints[0].ratio = kInfinity; }},
      {"offset that is no number", [kNaN](RobotWiring& w) { w.joints[0].offset_rad = kNaN; }},
      {"driver that is invalid", [](RobotWiring& w) { w.joints[2].driver = moteus::MoteusDriver{.id = 0}; }},
      {"two joints at one driver", [](RobotWiring& w) { w.joints[3].driver = w.joints[2].driver; }},
      {"half a direction of the pitch", [](RobotWiring& w) { w.pitch_direction = 0.5; }},
      {"offset of the pitch that is no number", [kNaN](RobotWiring& w) { w.pitch_offset_rad = kNaN; }},
      {"channel of no bits", [](RobotWiring& w) { w.channels[1].bits = 0; }},
      {"torso encoder at a driver that reports none", [](RobotWiring& w) { w.pitch_encoder_joint = 1; }},
      {"torso encoder at an ODrive",
       [](RobotWiring& w) {
         w.joints[3].driver = odrive::OdriveDriver{.node = 1, .endpoints = {}};
         w.pitch_encoder_joint = 3;
       }},
      {"ODrive beyond the nodes there are",
       [](RobotWiring& w) { w.joints[3].driver = odrive::OdriveDriver{.node = 64, .endpoints = {}}; }},
  };
  for (const auto& [name, fault] : faults) {
    RobotWiring wiring = good;
    fault(wiring);
    EXPECT_FALSE(valid(wiring, 2)) << name;
  }
  EXPECT_FALSE(valid(good, 0));
  EXPECT_FALSE(valid(good, kMaximumBuses + 1));
}

TEST(RobotWiring, OneIdentifierOnTwoBusesIsTwoDrivers) {
  RobotWiring wiring = Robot(Kind::moteus).wiring_;
  EXPECT_EQ(std::get<moteus::MoteusDriver>(wiring.joints[1].driver).id,
            std::get<moteus::MoteusDriver>(wiring.joints[3].driver).id);
  EXPECT_TRUE(valid(wiring, 2));
  wiring.joints[1].driver = odrive::OdriveDriver{.node = 1, .endpoints = {}};
  EXPECT_TRUE(valid(wiring, 2)) << "node 1 beside moteus 1";
}

}  // namespace
}  // namespace stilt::hal
