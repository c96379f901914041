#include "host_tools/gait_synthesis/synthesize.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "host_tools/gait_synthesis/gait_check.h"
#include "tests/host_tools/gait_synthesis/sample_gaits.h"
#include "tests/robots.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitRecord;

TEST(Synthesis, FindsValidGaitsForwardInPlaceAndBackward) {
  for (const double speed_m_s : {0.5, 0.0, -0.3}) {
    const StepTask task = task_at(speed_m_s);
    const GaitRecord record =
        make_record(testing_support::amber3m(), task, synthesize(testing_support::amber3m(), task));
    const GaitCheck check = check_gait(testing_support::amber3m(), record);
    EXPECT_TRUE(check.valid()) << speed_m_s << " m/s: " << joined(check.violations);
    EXPECT_NEAR(record.gait.step_length_m / record.gait.step_time_s, speed_m_s, 1e-5);
    EXPECT_LE(check.metrics.defect_max, 1e-6);
  }
}

TEST(Synthesis, KeepsToNarrowerLimitsAtAHigherCost) {
  StepTask task = task_at(0.5);
  task.limits.torque_Nm = 30.0;
  task.limits.pitch_rad = 0.02;
  const Synthesis narrow = synthesize(testing_support::amber3m(), task);
  const GaitCheck check =
      check_gait(testing_support::amber3m(), make_record(testing_support::amber3m(), task, narrow));
  EXPECT_TRUE(check.valid()) << joined(check.violations);
  EXPECT_LE(check.metrics.pitch_max_rad, 0.02);
  EXPECT_GT(check.metrics.torque_squared_per_m, walking_record().claims->torque_squared_per_m);
}

TEST(Synthesis, KeepsToTheRobotsOwnLimits) {
  const gait_files::GaitMetrics& usual = *walking_record().claims;
  const auto largest = [](double stance, double swing) { return std::max(stance, swing); };
  const double torque_Nm = 0.9 * largest(usual.peak_torque_Nm[1], usual.peak_torque_Nm[3]);
  const double speed_rad_s = 0.95 * largest(usual.peak_joint_speed_rad_s[1], usual.peak_joint_speed_rad_s[3]);
  const model::RobotModel weak = with_knee_L(torque_Nm, speed_rad_s);
  const GaitRecord record = make_record(weak, task_at(0.5), synthesize(weak, task_at(0.5)));
  EXPECT_TRUE(check_gait(weak, record).valid()) << joined(check_gait(weak, record).violations);
  for (const int knee : {1, 3}) {
    EXPECT_LE(record.claims->peak_torque_Nm[knee], torque_Nm);
    EXPECT_LE(record.claims->peak_joint_speed_rad_s[knee], speed_rad_s);
  }
}

TEST(Synthesis, KeepsToTheRangesOfBothLegs) {
  for (const int knee : {1, 3}) {
    const model::RobotModel stopped = with_stop(knee, 0.32);
    const GaitRecord record = make_record(stopped, task_at(0.5), synthesize(stopped, task_at(0.5)));
    EXPECT_TRUE(check_gait(stopped, record).valid()) << joined(check_gait(stopped, record).violations);
    EXPECT_GE(record.claims->knee_min_rad, 0.32 + record.limits.joint_position_margin_rad)
        << "joint " << knee;
  }
}

TEST(Synthesis, SaysSoWhenThereIsNoGait) {
  StepTask task = task_at(0.5);
  task.limits.torque_Nm = 5.0;
  EXPECT_THROW((void)synthesize(testing_support::amber3m(), task), NoGait);
}

TEST(Synthesis, SaysSoWhenTheOptimumIsNoMotionOfTheHybridModel) {
  StepTask task = task_at(0.5);
  task.elements = 1;  // far too coarse
  task.element_degree = 3;
  try {
    (void)synthesize(testing_support::amber3m(), task);
    FAIL() << "a gait";
  } catch (const NoGait& none) {
    EXPECT_STREQ(none.what(),
                 "no gait at 0.5 m/s: the outputs give no periodic motion; try another step time or wider "
                 "limits");
  }
}

TEST(Synthesis, DoublesTheElementsOfAGridThatIsTooCoarse) {
  EXPECT_EQ(synthesize(testing_support::amber3m(), task_at(0.5)).elements, task_at(0.5).elements);
  StepTask task = task_at(0.5);
  task.elements = 2;
  const Synthesis found = synthesize(testing_support::amber3m(), task);
  EXPECT_EQ(found.elements, 8);
  const GaitRecord record = make_record(testing_support::amber3m(), task, found);
  const GaitCheck check = check_gait(testing_support::amber3m(), record);
  EXPECT_TRUE(check.valid()) << joined(check.violations);
}

TEST(Synthesis, FindsGaitsOfDrivesWithLittleReflectedInertia) {
  model::RobotModel robot = testing_support::amber3m();
  for (int j = 0; j < model::kJoints; ++j) robot.constants.joint_parameters[j] = 0.05;
  const GaitRecord record = make_record(robot, task_at(0.5), synthesize(robot, task_at(0.5)));
  const GaitCheck check = check_gait(robot, record);
  EXPECT_TRUE(check.valid()) << joined(check.violations);
}

TEST(Synthesis, EveryCostGivesItsOwnGait) {
  std::vector<double> squared_torque;
  for (const CostKind cost :
       {CostKind::torque_squared, CostKind::mechanical_power, CostKind::acceleration_squared}) {
    StepTask task = task_at(0.5);
    task.cost = cost;
    const GaitRecord record =
        make_record(testing_support::amber3m(), task, synthesize(testing_support::amber3m(), task));
    const GaitCheck check = check_gait(testing_support::amber3m(), record);
    EXPECT_TRUE(check.valid()) << joined(check.violations);
    squared_torque.push_back(record.claims->torque_squared_per_m);
  }
  EXPECT_LT(squared_torque[0], squared_torque[1]);
  EXPECT_LT(squared_torque[0], squared_torque[2]);
}

TEST(Synthesis, WorksForTheOtherRobotToo) {
  StepTask task = task_at(0.5);
  task.step_time_s = 0.4;
  const GaitRecord record =
      make_record(testing_support::rabbit(), task, synthesize(testing_support::rabbit(), task));
  const GaitCheck check = check_gait(testing_support::rabbit(), record);
  EXPECT_TRUE(check.valid()) << joined(check.violations);
}

}  // namespace
}  // namespace stilt::gait_synthesis
