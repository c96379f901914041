#include "mpc_core/gait/gait_library.h"

#include <gtest/gtest.h>

#include <memory>

namespace stilt::gait {
namespace {

/// A made-up gait whose every coefficient shows its speed.
HzdGait gait_of(double speed_m_s, PhaseKind phase = PhaseKind::hip_position) {
  HzdGait gait;
  gait.speed_m_s = speed_m_s;
  gait.step_time_s = 0.3;
  gait.step_length_m = 0.3 * speed_m_s;
  gait.outputs.phase = phase;
  gait.outputs.phase_start = -0.1 * speed_m_s;
  gait.outputs.phase_end = 0.2 * speed_m_s;
  gait.outputs.degree = 5;
  for (auto& row : gait.outputs.angle_rad) std::fill(std::begin(row), std::end(row), speed_m_s);
  gait.feedback.placement[3] = 2.0 * speed_m_s;
  gait.motion.degree = 4;
  for (auto& row : gait.motion.position) std::fill(std::begin(row), std::end(row), 10.0 * speed_m_s);
  for (auto& row : gait.motion.torque_Nm) std::fill(std::begin(row), std::end(row), 20.0 * speed_m_s);
  for (auto& row : gait.motion.force_N) std::fill(std::begin(row), std::end(row), 30.0 * speed_m_s);
  return gait;
}

class Library : public testing::Test {
 protected:
  void fill() {
    ASSERT_EQ(library_->add(gait_of(-0.2, PhaseKind::hip_position)), LibraryStatus::ok);
    ASSERT_EQ(library_->add(gait_of(0.0, PhaseKind::time)), LibraryStatus::ok);
    ASSERT_EQ(library_->add(gait_of(0.4)), LibraryStatus::ok);
    ASSERT_EQ(library_->add(gait_of(0.6)), LibraryStatus::ok);
  }
  HzdGait blended(double speed_m_s) {
    HzdGait gait;
    library_->blend(speed_m_s, gait);
    return gait;
  }
  std::unique_ptr<GaitLibrary> library_ = std::make_unique<GaitLibrary>();
};

TEST_F(Library, GivesAGaitOfItsOwnUnchangedAtItsSpeed) {
  fill();
  const HzdGait gait = blended(0.4);
  EXPECT_EQ(gait.speed_m_s, 0.4);
  EXPECT_EQ(gait.motion.position[2][1], 4.0);
  EXPECT_EQ(gait.outputs.angle_rad[1][5], 0.4);
  EXPECT_EQ(gait.outputs.phase, PhaseKind::hip_position);
}

TEST_F(Library, BlendsNeighboursInProportion) {
  fill();
  const HzdGait gait = blended(0.45);
  EXPECT_DOUBLE_EQ(gait.speed_m_s, 0.45);
  EXPECT_DOUBLE_EQ(gait.step_length_m, 0.135);
  EXPECT_DOUBLE_EQ(gait.motion.position[0][0], 4.5);
  EXPECT_DOUBLE_EQ(gait.motion.torque_Nm[3][4], 9.0);
  EXPECT_DOUBLE_EQ(gait.motion.force_N[1][2], 13.5);
  EXPECT_DOUBLE_EQ(gait.outputs.angle_rad[0][0], 0.45);
  EXPECT_DOUBLE_EQ(gait.outputs.phase_start, -0.045);
  EXPECT_DOUBLE_EQ(gait.feedback.placement[3], 0.9);
}

TEST_F(Library, TakesTheGaitAtTheEndForSpeedsBeyond) {
  fill();
  EXPECT_EQ(blended(3.0).speed_m_s, 0.6);
  EXPECT_EQ(blended(-3.0).motion.position[0][0], -2.0);
}

TEST_F(Library, TakesTheOutputsOfTheNearerGaitWherePhasesDiffer) {
  fill();
  EXPECT_EQ(blended(0.1).outputs.phase, PhaseKind::time);
  EXPECT_EQ(blended(0.1).outputs.angle_rad[0][0], 0.0);
  EXPECT_DOUBLE_EQ(blended(0.1).motion.position[0][0], 1.0);
  EXPECT_EQ(blended(0.3).outputs.phase, PhaseKind::hip_position);
  EXPECT_EQ(blended(0.3).outputs.angle_rad[0][0], 0.4);
}

TEST_F(Library, TakesTheOutputsOfTheNearerGaitBetweenTwoDirections) {
  ASSERT_EQ(library_->add(gait_of(-0.3)), LibraryStatus::ok);
  ASSERT_EQ(library_->add(gait_of(0.3)), LibraryStatus::ok);
  for (const double speed_m_s : {-0.02, 0.0, 0.02}) {
    const HzdGait gait = blended(speed_m_s);
    const double way_m = gait.outputs.phase_end - gait.outputs.phase_start;
    EXPECT_DOUBLE_EQ(way_m, speed_m_s < 0.0 ? -0.09 : 0.09) << speed_m_s;
    EXPECT_NEAR(gait.motion.position[0][0], 10.0 * speed_m_s, 1e-12) << "the motion is blended all the same";
  }
}

TEST_F(Library, RefusesWhatCannotBeBlended) {
  fill();
  EXPECT_EQ(library_->add(gait_of(0.6)), LibraryStatus::speeds_not_rising);
  HzdGait slower = gait_of(0.8);
  slower.step_time_s = 0.4;
  EXPECT_EQ(library_->add(slower), LibraryStatus::another_shape);
  HzdGait other = gait_of(0.8);
  other.motion.degree = 5;
  EXPECT_EQ(library_->add(other), LibraryStatus::another_shape);
  HzdGait bare = gait_of(0.8);
  bare.motion.degree = 0;
  EXPECT_EQ(library_->add(bare), LibraryStatus::motion_unknown);
  EXPECT_EQ(library_->count(), 4);
}

TEST_F(Library, IsFullAtItsCapacity) {
  for (int i = 0; i < GaitLibrary::kMaxGaits; ++i)
    ASSERT_EQ(library_->add(gait_of(0.01 * i)), LibraryStatus::ok);
  EXPECT_EQ(library_->add(gait_of(1.0)), LibraryStatus::full);
  library_->clear();
  EXPECT_EQ(library_->count(), 0);
  EXPECT_EQ(library_->step_time_s(), 0.0);
}

TEST(MotionAt, ScalesDerivativesByTheStepTime) {
  HzdGait gait = gait_of(0.5);
  gait.step_time_s = 0.25;
  for (int i = 0; i <= 4; ++i) gait.motion.position[0][i] = 0.1 * i;             // 0.4 s
  for (int i = 0; i <= 4; ++i) gait.motion.position[1][i] = i * (i - 1) / 12.0;  // s^2
  const GaitPoint point = motion_at(gait, 0.5);
  EXPECT_NEAR(point.position[0], 0.2, 1e-15);
  EXPECT_NEAR(point.velocity[0], 1.6, 1e-14);
  EXPECT_NEAR(point.acceleration[0], 0.0, 1e-12);
  EXPECT_NEAR(point.position[1], 0.25, 1e-15);
  EXPECT_NEAR(point.velocity[1], 4.0, 1e-14);
  EXPECT_NEAR(point.acceleration[1], 32.0, 1e-12);
}

TEST(PlacementShare, MovesTheSwingHipAloneFromNothingToAllFlatAtBothEnds) {
  const OutputPoint start = placement_share(0.0);
  const OutputPoint end = placement_share(1.0);
  EXPECT_EQ(start.angle_rad, model::JointVector::Zero());
  EXPECT_EQ(start.slope_rad, model::JointVector::Zero());
  EXPECT_EQ(end.angle_rad, model::JointVector(0.0, 0.0, 1.0, 0.0));
  EXPECT_EQ(end.slope_rad, model::JointVector::Zero());
  EXPECT_EQ(placement_share(1.3).angle_rad, end.angle_rad);
  EXPECT_EQ(placement_share(-0.3).angle_rad, start.angle_rad);
  EXPECT_NEAR(placement_share(0.5).angle_rad[2], 0.5, 1e-15);
}

}  // namespace
}  // namespace stilt::gait
