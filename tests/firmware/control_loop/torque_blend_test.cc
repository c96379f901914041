#include "firmware/control_loop/torque_blend.h"

#include <gtest/gtest.h>

#include "tests/firmware/supervisor/printers.h"

namespace stilt::control_loop {
namespace {

using supervisor::FallbackLevel;

constexpr double kDuration_s = 0.02;

class TorqueBlendTest : public ::testing::Test {
 protected:
  TorqueBlendTest() {
    blend_.configure(kDuration_s);
    blend_.remember({FallbackLevel::plan, 0});
  }

  /// Torque of joint 1 in a tick whose law asks for `law_Nm`, after a tick that asked for 10 Nm.
  double torque_Nm(FallbackLevel level, double time_s, double law_Nm) {
    hal::JointCommands wanted{};
    wanted[1].torque_Nm = law_Nm;
    blend_.fade({level, 0}, time_s, {0, 10, 0, 0}, wanted);
    return wanted[1].torque_Nm;
  }

  TorqueBlend blend_;
};

TEST_F(TorqueBlendTest, ChangesNothingWhileTheLevelStays) {
  EXPECT_EQ(torque_Nm(FallbackLevel::plan, 1.0, 40), 40);
}

TEST_F(TorqueBlendTest, AnotherLevelStartsFromTheTorqueBeforeAndIsActiveAfterItsTime) {
  EXPECT_NEAR(torque_Nm(FallbackLevel::gait, 1.0, 40), 10, 1e-12);
  EXPECT_NEAR(torque_Nm(FallbackLevel::gait, 1.0 + 0.5 * kDuration_s, 50), 50 - 15, 1e-9);
  EXPECT_NEAR(torque_Nm(FallbackLevel::gait, 1.0 + kDuration_s, 50), 50, 1e-9);
  EXPECT_NEAR(torque_Nm(FallbackLevel::gait, 2.0, -20), -20, 1e-12);
}

TEST_F(TorqueBlendTest, NothingFadesOnTheRampOrAfterIt) {
  blend_.remember({FallbackLevel::gait, 0});
  EXPECT_EQ(torque_Nm(FallbackLevel::gait, 1.0, 40), 40);
}

TEST_F(TorqueBlendTest, WithoutATimeTheNewTorqueIsActiveAtOnce) {
  blend_.configure(0.0);
  blend_.remember({FallbackLevel::plan, 0});
  EXPECT_EQ(torque_Nm(FallbackLevel::gait, 1.0, 40), 40);
}

}  // namespace
}  // namespace stilt::control_loop
