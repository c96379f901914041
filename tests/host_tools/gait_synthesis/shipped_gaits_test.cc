#include "firmware/configuration/gaits/shipped_gaits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "firmware/configuration/gaits/gait_file.h"
#include "host_tools/gait_synthesis/gait_check.h"
#include "host_tools/gait_synthesis/synthesize.h"
#include "tests/robots.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitRecord;
using gait_files::ShippedGait;

class ShippedGaitTest : public testing::TestWithParam<ShippedGait> {
 protected:
  [[nodiscard]] GaitRecord record() const {
    auto parsed = gait_files::parse_gait(GetParam().text, GetParam().path);
    EXPECT_TRUE(parsed) << parsed.error();
    return std::move(*parsed);
  }
  [[nodiscard]] const model::RobotModel& robot() const {
    return *testing_support::find_robot(std::string(GetParam().robot));
  }
};

TEST_P(ShippedGaitTest, IsValidAndClaimsNothingThatIsNotSo) {
  const GaitRecord shipped = record();
  ASSERT_TRUE(shipped.claims);
  const GaitCheck check = check_gait(robot(), shipped);
  std::string names;
  for (const Violation& violation : check.violations) names += violation.text() + "; ";
  EXPECT_TRUE(check.valid()) << names;
}

TEST_P(ShippedGaitTest, IsWhatTheSearchFindsNow) {
  const GaitRecord shipped = record();
  StepTask task;
  task.speed_m_s = shipped.gait.speed_m_s;
  task.phase = phase_for_speed(task.speed_m_s);
  const GaitRecord found = make_record(robot(), task, synthesize(robot(), task));
  EXPECT_EQ(found.gait.outputs.phase, shipped.gait.outputs.phase);
  for (int i = 0; i <= 20; ++i) {
    const auto wanted = gait::motion_at(shipped.gait, 0.05 * i);
    const auto got = gait::motion_at(found.gait, 0.05 * i);
    EXPECT_LT((got.position - wanted.position).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((got.torque_Nm - wanted.torque_Nm).cwiseAbs().maxCoeff(), 0.05);
  }
  GaitRecord a = shipped;
  GaitRecord b = found;
  for (const auto& field : gait_files::limit_fields()) {
    EXPECT_EQ(field.values(a.limits)[0], field.values(b.limits)[0]) << field.key;
  }
}

std::string test_name(const testing::TestParamInfo<ShippedGait>& gait) {
  std::string name;
  for (const char c : gait.param.path.substr(gait.param.path.rfind('/') + 1)) {
    name += c == '-' ? 'm' : (c == '.' ? '_' : c);
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedGaitTest, testing::ValuesIn(gait_files::shipped_gaits()), test_name);

TEST(ShippedLibrary, BlendsToMotionsThatNearlyKeepTheFootAndTheDynamics) {
  // A blend of two gaits is no gait; half way between neighbours it is still a good reference.
  const auto library = std::make_unique<gait::GaitLibrary>();
  ASSERT_TRUE(gait_files::load_shipped_library("amber3m", *library));
  for (double speed_m_s = -0.35; speed_m_s < 1.0; speed_m_s += 0.1) {
    gait::HzdGait gait;
    library->blend(speed_m_s, gait);
    EXPECT_NEAR(gait.step_length_m / gait.step_time_s, speed_m_s, 1e-4);
    for (int i = 0; i <= 20; ++i) {
      const auto point = gait::motion_at(gait, 0.05 * i);
      model::StateVector x;
      x << point.position, point.velocity;
      model::KinematicsTerms<double> feet;
      testing_support::amber3m().kinematics(x.data(), feet);
      EXPECT_NEAR(feet.foot_position[0], 0.0, 1e-3) << speed_m_s << " m/s, stance foot";
      EXPECT_NEAR(feet.foot_position[1], 0.0, 1e-3) << speed_m_s << " m/s, stance foot";
      EXPECT_LT(std::hypot(feet.foot_velocity[0], feet.foot_velocity[1]), 0.05)
          << speed_m_s << " m/s, stance foot";
    }
  }
}

}  // namespace
}  // namespace stilt::gait_synthesis
