#include "host_tools/gait_synthesis/gait_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "firmware/configuration/gaits/gait_file.h"
#include "host_tools/gait_synthesis/gait_page.h"
#include "host_tools/gait_synthesis/hybrid_step.h"
#include "host_tools/gait_synthesis/likely_mistake.h"
#include "host_tools/gait_synthesis/return_map.h"
#include "tests/host_tools/gait_synthesis/sample_gaits.h"
#include "tests/robots.h"

namespace stilt::gait_synthesis {
namespace {

using gait_files::GaitRecord;

bool violates(const GaitRecord& record, const std::string& name) {
  const GaitCheck check = check_gait(testing_support::amber3m(), record);
  return std::ranges::find(check.violations, name, &Violation::name) != check.violations.end();
}

TEST(Check, AGaitKeepsToTheRobotsOwnLimitsToo) {
  const gait_files::GaitMetrics& usual = *walking_record().claims;
  const auto found_with = [](double torque_Nm, double speed_rad_s) {
    return check_gait(with_knee_L(torque_Nm, speed_rad_s), walking_record()).violations;
  };
  EXPECT_TRUE(found_with(80.0, 10.0).empty());
  const std::vector<Violation> weak = found_with(5.0, 10.0);
  ASSERT_EQ(weak.size(), 1u) << joined(weak);
  EXPECT_EQ(weak[0].name, "torque_Nm");
  EXPECT_EQ(weak[0].bound, 5.0);
  EXPECT_NEAR(weak[0].value, std::max(usual.peak_torque_Nm[1], usual.peak_torque_Nm[3]), 1e-9);
  const std::vector<Violation> slow = found_with(80.0, 1.0);
  ASSERT_EQ(slow.size(), 1u) << joined(slow);
  EXPECT_EQ(slow[0].name, "joint_speed_rad_s");
  EXPECT_EQ(slow[0].bound, 1.0);
}

TEST(Check, AGaitKeepsToTheRangesOfBothLegs) {
  GaitRecord record = walking_record();
  record.claims.reset();
  const auto found_with = [&](const model::RobotModel& robot) {
    return check_gait(robot, record).violations;
  };
  for (const int knee : {1, 3}) {
    const std::vector<Violation> stopped = found_with(with_stop(knee, 0.32));
    ASSERT_EQ(stopped.size(), 1u) << joined(stopped);
    EXPECT_EQ(stopped[0].name, "joint_position_margin_rad");
    EXPECT_NEAR(stopped[0].value, walking_record().claims->knee_min_rad - 0.32, 1e-9) << "joint " << knee;
  }
  // The knee of the swing leg bends more than the other, and each knee is in turn that of the swing leg.
  double margin_rad[2];
  for (const int leg : {0, 1}) {
    model::RobotModel narrow = testing_support::amber3m();
    narrow.constants.position_max_rad[2 * leg + 1] = 0.5;
    const std::vector<Violation> stopped = found_with(narrow);
    ASSERT_EQ(stopped.size(), 1u) << joined(stopped);
    EXPECT_EQ(stopped[0].name, "joint_position_margin_rad");
    margin_rad[leg] = stopped[0].value;
  }
  EXPECT_EQ(margin_rad[0], margin_rad[1]);
}

TEST(UnequalLegs, DifferInArmatureOrDampingOfHipOrKnee) {
  EXPECT_EQ(unequal_legs(testing_support::amber3m().constants), "");
  const std::pair<int, const char*> cases[] = {{0, "hip_L and hip_R have different armature"},
                                               {3, "knee_L and knee_R have different armature"},
                                               {6, "hip_L and hip_R have different damping"},
                                               {5, "knee_L and knee_R have different damping"}};
  for (const auto& [at, text] : cases) {
    model::RobotConstants robot = testing_support::amber3m().constants;
    robot.joint_parameters[at] += 0.01;
    EXPECT_EQ(unequal_legs(robot),
              std::string("amber3m: ") + text + "; gaits are for robots with equal legs");
  }
}

TEST(Replay, StaysOnTheGaitOverManyStepsAndComesBackAfterADisturbance) {
  const StepTask slow = task_at(0.1);  // along the time, so with foot placement
  const GaitRecord slow_record =
      make_record(testing_support::amber3m(), slow, synthesize(testing_support::amber3m(), slow));
  for (const GaitRecord* record : {&walking_record(), &stepping_record(), &slow_record}) {
    const ReducedState nominal = reduce(start_of_motion(record->gait));
    ReducedState at = nominal;
    at[0] += 0.01;
    at[5] -= 0.05;
    for (int step = 0; step < 100; ++step) {
      const auto outcome =
          integrate_step(testing_support::amber3m(), record->gait, expand(testing_support::amber3m(), at));
      ASSERT_TRUE(outcome) << "step " << step;
      at = reduce(outcome->after);
    }
    EXPECT_LT((at - nominal).cwiseAbs().maxCoeff(), 1e-4);
  }
}

TEST(Check, NamesTheLimitThatIsNotKept) {
  const auto with = [](auto change) {
    GaitRecord record = walking_record();
    change(record.limits);
    return record;
  };
  EXPECT_FALSE(violates(walking_record(), "torque_Nm"));
  EXPECT_TRUE(violates(with([](auto& l) { l.torque_Nm = 20.0; }), "torque_Nm"));
  EXPECT_TRUE(violates(with([](auto& l) { l.joint_speed_rad_s = 1.0; }), "joint_speed_rad_s"));
  EXPECT_TRUE(
      violates(with([](auto& l) { l.joint_position_margin_rad = 0.5; }), "joint_position_margin_rad"));
  EXPECT_TRUE(violates(with([](auto& l) { l.knee_min_rad = 0.5; }), "knee_min_rad"));
  EXPECT_TRUE(violates(with([](auto& l) { l.pitch_rad = 0.01; }), "pitch_rad"));
  EXPECT_TRUE(violates(with([](auto& l) { l.friction_ratio = 0.01; }), "friction_ratio"));
  EXPECT_TRUE(violates(with([](auto& l) { l.normal_force_min_N = 200.0; }), "normal_force_min_N"));
  EXPECT_TRUE(violates(with([](auto& l) { l.impulse_ratio = 0.001; }), "impulse_ratio"));
  EXPECT_TRUE(violates(with([](auto& l) { l.clearance_m = 0.1; }), "clearance_m"));
  EXPECT_TRUE(violates(with([](auto& l) { l.touchdown_speed_min_m_s = 0.6; }), "touchdown_speed_min_m_s"));
  EXPECT_TRUE(violates(with([](auto& l) { l.touchdown_speed_max_m_s = 0.11; }), "touchdown_speed_max_m_s"));
  EXPECT_TRUE(violates(with([](auto& l) { l.touchdown_slip_m_s = 0.001; }), "touchdown_slip_m_s"));
  EXPECT_TRUE(violates(with([](auto& l) { l.return_map = 0.5; }), "return_map"));
}

TEST(Check, ABackwardGaitSlipsBackwardAndIsBoundAsWell) {
  const StepTask task = task_at(-0.3);
  GaitRecord record =
      make_record(testing_support::amber3m(), task, synthesize(testing_support::amber3m(), task));
  ASSERT_LT(record.claims->touchdown_slip_m_s, -0.1);
  EXPECT_FALSE(violates(record, "touchdown_slip_m_s"));
  record.limits.touchdown_slip_m_s = 0.05;
  EXPECT_TRUE(violates(record, "touchdown_slip_m_s"));
}

TEST(Check, AViolationHasTheValueThatWasComputedAndItsBound) {
  GaitRecord record = walking_record();
  const gait_files::GaitMetrics metrics = *record.claims;
  record.limits.torque_Nm = 20.0;
  record.limits.clearance_m = 0.1;
  record.claims->peak_torque_Nm[2] += 1.0;
  record.gait.speed_m_s += 0.125;
  const std::vector<Violation> found = check_gait(testing_support::amber3m(), record).violations;
  ASSERT_EQ(found.size(), 4u) << joined(found);
  EXPECT_EQ(found[0].name, "speed");
  EXPECT_NEAR(found[0].value, 0.125, 1e-5);
  EXPECT_EQ(found[0].text(), "speed 0.125, at most 1e-05");
  EXPECT_EQ(found[1].name, "torque_Nm");
  EXPECT_NEAR(found[1].value, *std::ranges::max_element(metrics.peak_torque_Nm), 1e-9);
  EXPECT_EQ(found[1].bound, 20.0);
  EXPECT_STREQ(name(found[1].kind), "at most");
  EXPECT_EQ(found[2].name, "clearance_m");
  EXPECT_NEAR(found[2].value, metrics.clearance_m, 1e-9);
  EXPECT_STREQ(name(found[2].kind), "at least");
  EXPECT_EQ(found[3].name, "claim peak_torque_Nm");
  EXPECT_NEAR(found[3].value + 1.0, found[3].bound, 1e-9);
  EXPECT_STREQ(name(found[3].kind), "claimed");
}

TEST(Check, TheAccuracyOfAMotionIsNoLimit) {
  GaitRecord record = walking_record();
  record.limits.torque_Nm = 20.0;
  record.gait.motion.position[2][7] += 1e-3;
  record.claims.reset();
  std::vector<std::string> accuracy;
  for (const Violation& violation : check_gait(testing_support::amber3m(), record).violations) {
    if (violation.accuracy) accuracy.push_back(violation.name);
  }
  EXPECT_EQ(std::ranges::count(accuracy, "defect"), 1);
  EXPECT_EQ(std::ranges::count(accuracy, "torque_Nm"), 0);
}

TEST(Check, WhatIsNotANumberKeepsNoBoundAndMakesNoClaimTrue) {
  GaitRecord record = walking_record();
  record.limits.torque_Nm = record.limits.knee_min_rad = record.claims->pitch_max_rad = std::nan("");
  const GaitCheck check = check_gait(testing_support::amber3m(), record);
  ASSERT_EQ(check.violations.size(), 3u) << joined(check.violations);
  EXPECT_EQ(check.violations[0].name, "torque_Nm");
  EXPECT_EQ(check.violations[1].name, "knee_min_rad");
  EXPECT_EQ(check.violations[2].name, "claim pitch_max_rad");
}

TEST(Check, AnInfiniteClaimIsTrueOfAnInfiniteValueAlone) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  GaitRecord pulls = walking_record();
  pulls.gait.outputs.angle_rad[1][3] += 1.1;  // so fast a stance knee that the foot would lift off
  pulls.gait.outputs.angle_rad[0][3] -= 0.55;
  pulls.gait.step_time_s = pulls.gait.speed_m_s = 0.0;  // to be found
  complete_motion(testing_support::amber3m(), pulls.gait);
  pulls.claims = check_gait(testing_support::amber3m(), pulls).metrics;
  ASSERT_EQ(pulls.claims->friction_ratio_max, kInfinity);
  EXPECT_FALSE(violates(pulls, "claim friction_ratio_max"));
  pulls.claims->friction_ratio_max = 0.5;
  EXPECT_TRUE(violates(pulls, "claim friction_ratio_max"));
  GaitRecord walks = walking_record();
  walks.claims->friction_ratio_max = kInfinity;
  EXPECT_TRUE(violates(walks, "claim friction_ratio_max"));
}

TEST(Check, NamesAClaimThatIsNotTrue) {
  GaitRecord record = walking_record();
  record.claims->peak_torque_Nm[2] += 1.0;
  EXPECT_TRUE(violates(record, "claim peak_torque_Nm"));
  record.claims->return_map_eigenvalues[0] = 0.5;
  EXPECT_TRUE(violates(record, "claim return_map_eigenvalues"));
  record.gait.speed_m_s = 0.6;
  EXPECT_TRUE(violates(record, "speed"));
}

TEST(Check, FindsACoefficientThatWasTamperedWith) {
  GaitRecord record = walking_record();
  record.gait.motion.position[2][7] += 1e-3;
  EXPECT_TRUE(violates(record, "defect"));
  record = walking_record();
  record.gait.motion.torque_Nm[0][5] += 1.0;
  EXPECT_TRUE(violates(record, "torque_curve"));
  record = walking_record();
  record.gait.outputs.angle_rad[1][3] += 1e-3;
  EXPECT_TRUE(violates(record, "outputs"));
  EXPECT_TRUE(violates(record, "replay"));
  record = walking_record();
  record.gait.motion.position[5][gait::kMaxMotionDegree - 2] += 1e-3;
  EXPECT_TRUE(violates(record, "periodicity"));
}

TEST(Check, AGaitThatFallsInItsReplayHasNoFiniteError) {
  GaitRecord record = walking_record();
  for (double& coefficient : record.gait.motion.position[2]) coefficient += 1.5;  // the pitch
  EXPECT_TRUE(violates(record, "replay"));
  EXPECT_TRUE(std::isinf(check_gait(testing_support::amber3m(), record).metrics.replay_error_max));
}

TEST(Check, FindsAGaitThatFallsWhenDisturbedOrIsUnstable) {
  GaitRecord record = stepping_record();
  std::fill(std::begin(record.gait.feedback.placement), std::end(record.gait.feedback.placement), 0.0);
  EXPECT_TRUE(violates(record, "return_map"))
      << "by time and without foot placement it is no better than a stilt";
}

/// What is left of a gait in a file from elsewhere.
GaitRecord bare(const GaitRecord& record) {
  GaitRecord result;
  result.robot = record.robot;
  result.gait.outputs = record.gait.outputs;
  if (record.gait.outputs.phase == gait::PhaseKind::time) result.gait.step_time_s = record.gait.step_time_s;
  return result;
}

TEST(CompleteMotion, FindsTheMotionAgainFromOutputsAlone) {
  for (const GaitRecord* record : {&walking_record(), &stepping_record()}) {
    GaitRecord found = bare(*record);
    complete_motion(testing_support::amber3m(), found.gait);
    EXPECT_NEAR(found.gait.speed_m_s, record->gait.speed_m_s, 1e-6);
    EXPECT_NEAR(found.gait.step_time_s, record->gait.step_time_s, 1e-6);
    for (int i = 0; i <= 10; ++i) {
      const double s = 0.1 * i;
      const auto wanted = gait::motion_at(record->gait, s);
      const auto got = gait::motion_at(found.gait, s);
      EXPECT_LT((got.position - wanted.position).cwiseAbs().maxCoeff(), 1e-6);
      EXPECT_LT((got.torque_Nm - wanted.torque_Nm).cwiseAbs().maxCoeff(), 1e-2);
    }
  }
}

TEST(CompleteMotion, FindsThePlacementOfAGaitAgainstTime) {
  const StepTask slow = task_at(0.1);
  const GaitRecord record =
      make_record(testing_support::amber3m(), slow, synthesize(testing_support::amber3m(), slow));
  for (const GaitRecord* one : {&stepping_record(), &record}) {
    GaitRecord found = bare(*one);
    complete_motion(testing_support::amber3m(), found.gait);
    const GaitCheck check = check_gait(testing_support::amber3m(), found);
    EXPECT_TRUE(check.valid()) << joined(check.violations);
    for (std::size_t i = 0; i < gait::kReducedStates; ++i) {
      EXPECT_NEAR(found.gait.feedback.placement[i], one->gait.feedback.placement[i], 1e-3) << i;
    }
  }
}

TEST(CompleteMotion, KeepsAPlacementThatWasGiven) {
  GaitRecord found = bare(stepping_record());
  found.gait.feedback = stepping_gait().feedback;
  found.gait.feedback.placement[0] += 0.01;
  const gait::OutputFeedback given = found.gait.feedback;
  complete_motion(testing_support::amber3m(), found.gait);
  EXPECT_TRUE(std::ranges::equal(found.gait.feedback.placement, given.placement));
  const GaitCheck check = check_gait(testing_support::amber3m(), found);
  EXPECT_TRUE(check.valid()) << joined(check.violations);
}

TEST(CompleteMotion, LeavesTheFeetOfAGaitAlongTheHip) {
  GaitRecord found = bare(walking_record());
  complete_motion(testing_support::amber3m(), found.gait);
  EXPECT_TRUE(std::ranges::all_of(found.gait.feedback.placement, [](double gain) { return gain == 0.0; }));
}

TEST(CompleteMotion, TakesOutputsOfEveryDegreeFromFourToSeven) {
  for (int degree = 4; degree <= 7; ++degree) {
    StepTask task = task_at(0.5);
    task.output_degree = degree;
    GaitRecord record =
        make_record(testing_support::amber3m(), task, synthesize(testing_support::amber3m(), task));
    EXPECT_TRUE(check_gait(testing_support::amber3m(), record).valid()) << "degree " << degree;
    GaitRecord found = bare(record);
    complete_motion(testing_support::amber3m(), found.gait);
    EXPECT_NEAR(found.gait.speed_m_s, 0.5, 1e-5) << "degree " << degree;
  }
}

TEST(CompleteMotion, SaysSoWhenOutputsDoNotWalk) {
  gait::HzdGait gait = bare(walking_record()).gait;
  for (auto& row : gait.outputs.angle_rad) std::fill(std::begin(row), std::end(row), 0.4);
  EXPECT_THROW(complete_motion(testing_support::amber3m(), gait), std::runtime_error);
}

/// Outputs as a user may get them wrong, by the correction that is to be named.
TEST(LikelyMistake, IsTheOneThatWasMade) {
  using gait::GaitOutputs;
  const auto scale = [](GaitOutputs& o, double factor) {
    for (auto& row : o.angle_rad) {
      for (double& angle : row) angle *= factor;
    }
  };
  const std::pair<const char*, std::function<void(GaitOutputs&)>> mistakes[] = {
      {"the angles are taken as degrees", [&](GaitOutputs& o) { scale(o, 57.29577951308232); }},
      {"the signs of all angles are changed", [&](GaitOutputs& o) { scale(o, -1.0); }},
      {"stance and swing leg are exchanged",
       [](GaitOutputs& o) {
         std::swap(o.angle_rad[0], o.angle_rad[2]);
         std::swap(o.angle_rad[1], o.angle_rad[3]);
       }},
      {"hip and knee of the stance leg are exchanged",
       [](GaitOutputs& o) { std::swap(o.angle_rad[0], o.angle_rad[1]); }},
      {"hip and knee of both legs are exchanged",
       [](GaitOutputs& o) {
         std::swap(o.angle_rad[0], o.angle_rad[1]);
         std::swap(o.angle_rad[2], o.angle_rad[3]);
       }},
      {"the angles of the knees are taken from the torso, not from the thigh",
       [](GaitOutputs& o) {
         for (int i = 0; i <= o.degree; ++i) {
           o.angle_rad[1][i] += o.angle_rad[0][i];
           o.angle_rad[3][i] += o.angle_rad[2][i];
         }
       }},
      {"start and end of the phase are exchanged",
       [](GaitOutputs& o) { std::swap(o.phase_start, o.phase_end); }},
      {"the phase is taken as centimetres",
       [](GaitOutputs& o) {
         o.phase_start *= 100.0;
         o.phase_end *= 100.0;
       }},
  };
  for (const auto& [name, make] : mistakes) {
    gait::HzdGait gait = bare(walking_record()).gait;
    make(gait.outputs);
    EXPECT_EQ(likely_mistake(testing_support::amber3m(), gait).value_or("none"), name);
  }
}

TEST(LikelyMistake, IsNoneOfOutputsThatNoCorrectionMakesWalk) {
  gait::HzdGait gait = bare(walking_record()).gait;
  for (auto& row : gait.outputs.angle_rad) std::fill(std::begin(row), std::end(row), 0.4);
  EXPECT_FALSE(likely_mistake(testing_support::amber3m(), gait));
}

TEST(GaitPage, DrawsEverythingAndLoadsNothing) {
  GaitRecord record = walking_record();
  record.origin.emplace_back("note", "<script>alert(1)</script>");
  const std::string page =
      render_gait_page(testing_support::amber3m(), record, check_gait(testing_support::amber3m(), record));
  for (const char* title :
       {"One step, posture by posture", "Phase portrait of the hips", "Phase portrait of the knees",
        "Joint angles", "Joint torques", "Path of the swing foot", "Force on the stance foot"}) {
    EXPECT_NE(page.find(title), std::string::npos) << title;
  }
  for (const char* loader : {"http", "src=", "<link", "@import", "<script", "nan"}) {
    EXPECT_EQ(page.find(loader), std::string::npos) << loader;
  }
}

}  // namespace
}  // namespace stilt::gait_synthesis
