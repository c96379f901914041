#include "mpc_core/gait/reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/mpc_core/printers.h"
#include "tests/robots.h"

namespace stilt::gait {
namespace {

using model::kJoints;
using model::kPositions;

struct Options {
  GaitCommand command{GaitKind::walk, 0.5};
  double time_s = 0.4;
  double speed_m_s = 0.5;
  double trim_m_s = 0.0;
  double double_support_s = 0.0;
  double standing_since_s = 0.0;
  double measured_m_s = 0.3;
  double foothold_gain_s = 0.0;
};

/// A reference under way: walking was commanded at 0, the first lift-off is at 0.3.
struct Walk {
  GaitParameters gait{.single_support_s = 0.4};
  ReferenceParameters parameters;
  ContactSchedule schedule;
  HeuristicReference reference;
  model::StateVector state = model::StateVector::Zero();
  model::FeetVector feet{0.1, 0.0, -0.12, 0.0};
  double end_s;

  explicit Walk(const Options& options) : end_s(options.time_s + 2.0) {
    gait.double_support_s = options.double_support_s;
    schedule.reset(options.standing_since_s);
    for (const double time_s : {0.0, options.time_s}) {
      schedule.update(time_s, end_s + 2.0, options.command, gait, parameters, options.speed_m_s, true);
    }
    state[0] = 0.07;
    state[kPositions] = options.measured_m_s;
    parameters.foothold_gain_s = options.foothold_gain_s;
    reference.prepare(testing_support::amber3m().constants, schedule, options.command, gait, parameters,
                      options.time_s, state, feet, options.speed_m_s, options.trim_m_s);
  }

  [[nodiscard]] ReferencePoint at(double time_s) const {
    return reference.evaluate(time_s, schedule.index_at(time_s));
  }
};

TEST(Reference, BaseMovesAtTheReferenceSpeedFromTheMeasuredPosition) {
  const Walk walk({});
  for (double t = 0.4; t < walk.end_s; t += 0.05) {
    const ReferencePoint point = walk.at(t);
    EXPECT_NEAR(point.state[0], 0.07 + 0.5 * (t - 0.4), 1e-12);
    EXPECT_NEAR(point.state[kPositions], 0.5, 1e-12);
    EXPECT_EQ(point.state[1], walk.parameters.base_height_m);
    EXPECT_EQ(point.state[2], walk.parameters.base_pitch_rad);
    EXPECT_EQ(point.state.tail<kJoints>().norm(), 0.0);
  }
}

TEST(Reference, BaseProgressIntegratesTheSpeedThroughRampsSwitchesAndTrim) {
  for (const double target_m_s : {0.8, -0.6, 0.0}) {
    for (const double trim_m_s : {0.0, 0.1}) {
      // Standing until 0.3: the speed begins to change with the first step.
      const Walk walk(
          {.command = {GaitKind::walk, target_m_s}, .time_s = 0.05, .speed_m_s = 0.0, .trim_m_s = trim_m_s});
      double x_m = walk.at(0.05).state[0];
      EXPECT_NEAR(x_m, 0.5 * (walk.feet[0] + walk.feet[2]), 1e-12) << "standing, between the feet";
      constexpr double kStep_s = 1e-4;
      for (double t = 0.05; t < walk.end_s; t += kStep_s) {
        const double middle_m_s = walk.at(t + 0.5 * kStep_s).state[kPositions];
        x_m += kStep_s * middle_m_s;
        ASSERT_NEAR(walk.at(t + kStep_s).state[0], x_m, 5e-5) << "at " << t << " target " << target_m_s;
      }
      EXPECT_NEAR(walk.at(0.2).state[kPositions], 0.0, 1e-12);
      EXPECT_NEAR(walk.at(walk.end_s).state[kPositions], target_m_s + trim_m_s, 1e-12);
      const double half_ramp_s = 0.5 * std::abs(target_m_s) / walk.parameters.speed_ramp_m_s2;
      EXPECT_NEAR(walk.reference.speed_at(0.3 + half_ramp_s), 0.5 * target_m_s, 1e-12) << "without trim";
    }
  }
}

TEST(Reference, ForcesOfTheStanceFeetShareTheWeight) {
  for (const double double_support_s : {0.0, 0.06}) {
    const Walk walk({.double_support_s = double_support_s});
    const double weight_N = testing_support::amber3m().constants.total_mass_kg * model::kGravity_m_s2;
    for (double t = 0.4; t < walk.end_s; t += 0.01) {
      const ReferencePoint point = walk.at(t);
      const model::ContactMode mode = walk.schedule.phase(walk.schedule.index_at(t)).mode;
      EXPECT_NEAR(point.input[5] + point.input[7], weight_N, 1e-12);
      EXPECT_EQ(point.input[4], 0.0);
      EXPECT_EQ(point.input[6], 0.0);
      for (const int foot : {0, 1}) {
        const double share = mode[foot] ? 1.0 / mode.count() : 0.0;
        EXPECT_NEAR(point.input[kJoints + 2 * foot + 1], share * weight_N, 1e-12);
      }
      EXPECT_EQ(point.input.head<kJoints>().norm(), 0.0);
    }
  }
}

TEST(Reference, FootholdsLieBelowTheHipAtMidContact) {
  for (const double double_support_s : {0.0, 0.06}) {
    const Walk walk({.double_support_s = double_support_s});
    int seen = 0;
    for (double t = 0.4; t < walk.end_s; t += 0.01) {
      const int phase = walk.schedule.index_at(t);
      for (const int foot : {0, 1}) {
        const Interval contact = walk.schedule.foot_interval(phase, foot);
        if (!walk.schedule.phase(phase).mode[foot] || contact.start_s <= 0.4) continue;
        const double middle_s = 0.5 * (contact.start_s + contact.end_s);
        EXPECT_NEAR(walk.at(t).foot_position_W_m[2 * foot], walk.at(middle_s).state[0], 1e-12);
        ++seen;
      }
    }
    EXPECT_GT(seen, 100);
  }
}

TEST(Reference, TheSpeedReferenceStaysWithinABandOfTheMeasuredSpeedUpToTheLargestForwardSpeed) {
  const auto speed_at_start = [](double measured_m_s, double reference_m_s) {
    return Walk({.speed_m_s = reference_m_s, .measured_m_s = measured_m_s}).at(0.4).state[kPositions];
  };
  const ReferenceParameters p;
  for (const double inside_m_s : {-p.speed_follow_band_m_s, 0.0, p.speed_follow_band_m_s}) {
    EXPECT_NEAR(speed_at_start(0.5 + inside_m_s, 0.5), 0.5, 1e-12);
  }
  EXPECT_NEAR(speed_at_start(-1.0, 0.5), -1.0 + p.speed_follow_band_m_s, 1e-12);
  EXPECT_NEAR(speed_at_start(1.3, 0.5), 1.3 - p.speed_follow_band_m_s, 1e-12);
  EXPECT_NEAR(speed_at_start(3.0, 0.5), p.speed_follow_max_m_s, 1e-12);
  EXPECT_NEAR(speed_at_start(3.0, 1.7), 1.7, 1e-12) << "a commanded speed above it stays";
}

TEST(Reference, FootholdsShiftWithTheSpeedAboveTheReferenceLessForEachLaterOne) {
  const auto footholds = [](double measured_m_s, double gain_s, double time_s = 0.4) {
    const Walk walk({.time_s = time_s, .measured_m_s = measured_m_s, .foothold_gain_s = gain_s});
    std::vector<double> x_m;
    for (int phase = walk.schedule.index_at(time_s) + 1; walk.schedule.phase(phase).start_s < walk.end_s;
         ++phase) {
      const int foot = walk.schedule.phase(phase).mode.left ? 0 : 1;
      const double middle_s = 0.5 * (walk.schedule.phase(phase).start_s + walk.schedule.end_s(phase));
      x_m.push_back(walk.reference.evaluate(middle_s, phase).foot_position_W_m[2 * foot]);
    }
    return x_m;
  };
  constexpr double kGain_s = 0.2;
  const ReferenceParameters p;
  for (const double measured_m_s : {0.2, 0.9}) {
    const std::vector<double> without = footholds(measured_m_s, 0.0);
    const std::vector<double> with = footholds(measured_m_s, kGain_s);
    double shift_m = kGain_s * (measured_m_s - 0.5);
    for (std::size_t i = 0; i < with.size(); ++i, shift_m *= p.foothold_gain_decay) {
      EXPECT_NEAR(with[i] - without[i], shift_m, 1e-12) << "foothold " << i << " at " << measured_m_s;
    }
  }
  EXPECT_NEAR(footholds(3.0, kGain_s)[0] - footholds(3.0, 0.0)[0], p.foothold_shift_max_m, 1e-12);
  for (const double at_a_switch_s : {0.7, std::nextafter(0.7, 1.0), 0.7 + 1e-12}) {
    const double shift_m = footholds(0.9, kGain_s, at_a_switch_s)[0] - footholds(0.9, 0.0, at_a_switch_s)[0];
    EXPECT_NEAR(shift_m, kGain_s * 0.4, 1e-12) << "just begun, the next foothold is still the next";
  }
}

TEST(Reference, AFootOnTheGroundIsWhereItWasMeasuredAndAtRest) {
  const Walk walk({});
  const model::ContactMode mode = walk.schedule.phase(walk.schedule.index_at(0.4)).mode;
  ASSERT_EQ(mode.count(), 1);
  const int stance = mode.left ? 0 : 1;
  const ReferencePoint point = walk.at(0.5);
  EXPECT_EQ(point.foot_position_W_m[2 * stance], walk.feet[2 * stance]);
  EXPECT_EQ(point.foot_position_W_m[2 * stance + 1], 0.0);
  EXPECT_EQ(point.foot_velocity_W_m_s.segment<2>(2 * stance).norm(), 0.0);
  EXPECT_EQ(point.foot_acceleration_W_m_s2.segment<2>(2 * stance).norm(), 0.0);
}

TEST(Reference, FeetMoveWithoutJumpsThroughLiftOffAndTouchDown) {
  for (const GaitCommand command : {GaitCommand{GaitKind::walk, 0.5}, GaitCommand{GaitKind::walk, -0.4},
                                    GaitCommand{GaitKind::step, 0.0}}) {
    for (const double double_support_s : {0.0, 0.06}) {
      for (const double time_s : {0.1, 0.31, 0.5, 0.69}) {
        const Walk walk(
            {.command = command, .time_s = time_s, .speed_m_s = 0.2, .double_support_s = double_support_s});
        constexpr double kStep_s = 1e-4;
        ReferencePoint before = walk.at(time_s);
        for (double t = time_s + kStep_s; t < walk.end_s; t += kStep_s) {
          const ReferencePoint now = walk.at(t);
          // No foot is faster than 5 m/s anywhere.
          ASSERT_LT((now.foot_position_W_m - before.foot_position_W_m).lpNorm<Eigen::Infinity>(),
                    5.0 * kStep_s)
              << "at " << t;
          before = now;
        }
      }
    }
  }
}

TEST(Reference, FootVelocityAndAccelerationAreDerivativesWithinASwing) {
  const Walk walk({});
  constexpr double kStep_s = 1e-5;
  for (double t = 0.41; t < walk.end_s; t += 0.0131) {
    const int phase = walk.schedule.index_at(t);
    if (walk.schedule.index_at(t - kStep_s) != phase || walk.schedule.index_at(t + kStep_s) != phase)
      continue;
    const ReferencePoint now = walk.at(t);
    const ReferencePoint later = walk.at(t + kStep_s);
    const ReferencePoint earlier = walk.at(t - kStep_s);
    const model::FeetVector velocity =
        (later.foot_position_W_m - earlier.foot_position_W_m) / (2.0 * kStep_s);
    const model::FeetVector acceleration =
        (later.foot_velocity_W_m_s - earlier.foot_velocity_W_m_s) / (2.0 * kStep_s);
    EXPECT_LT((now.foot_velocity_W_m_s - velocity).norm(), 1e-6) << "at " << t;
    EXPECT_LT((now.foot_acceleration_W_m_s2 - acceleration).norm(), 1e-4) << "at " << t;
  }
}

TEST(Reference, SwingFootMeetsTheGroundWithTheTouchDownVelocity) {
  const Walk walk({});
  for (int phase = walk.schedule.index_at(0.4); walk.schedule.end_s(phase) < walk.end_s; ++phase) {
    const int swing = walk.schedule.phase(phase).mode.left ? 1 : 0;
    const ReferencePoint end = walk.reference.evaluate(walk.schedule.end_s(phase), phase);
    EXPECT_NEAR(end.foot_position_W_m[2 * swing + 1], 0.0, 1e-12);
    EXPECT_NEAR(end.foot_velocity_W_m_s[2 * swing + 1], walk.gait.touchdown_velocity_m_s, 1e-12);
    EXPECT_NEAR(end.foot_velocity_W_m_s[2 * swing], 0.0, 1e-12);
    const double middle_s = 0.5 * (walk.schedule.phase(phase).start_s + walk.schedule.end_s(phase));
    EXPECT_NEAR(walk.reference.evaluate(middle_s, phase).foot_position_W_m[2 * swing + 1],
                walk.gait.swing_height_m, 1e-12);
  }
}

TEST(Reference, ComingToAStandTheFootThatLandsLastStandsAhead) {
  for (const double stop_s : {0.45, 0.85}) {  // on either foot
    Walk walk({.time_s = stop_s});
    const GaitCommand stand{GaitKind::stand, 0.0};
    walk.schedule.update(stop_s, 4.0, stand, walk.gait, walk.parameters, 0.5, true);
    walk.reference.prepare(testing_support::amber3m().constants, walk.schedule, stand, walk.gait,
                           walk.parameters, stop_s, walk.state, walk.feet, 0.5, 0.0);
    const int last = walk.schedule.count() - 1;
    ASSERT_EQ(walk.schedule.phase(last).gait, GaitKind::stand);
    const int ahead = walk.schedule.phase(last - 1).mode.left ? 1 : 0;
    const ReferencePoint point = walk.at(walk.schedule.phase(last).start_s + 0.1);
    const model::FeetVector& feet = point.foot_position_W_m;
    // Asked for is twice the distance of a stand.
    EXPECT_NEAR(feet[2 * ahead] - feet[2 * (1 - ahead)], 4.0 * walk.gait.stand_half_width_m, 1e-9);
    EXPECT_NEAR(feet[2 * (1 - ahead)], point.state[0], 1e-9);
    EXPECT_NEAR(point.state[kPositions], 0.0, 1e-12);
  }
}

TEST(Reference, AFootThatLiftedOffCameFromBelowTheHipHalfAStepBeforeHoweverLongItStood) {
  for (const double standing_since_s : {-0.1, -1.0, -60.0}) {
    const Walk walk({.standing_since_s = standing_since_s});
    const int phase = walk.schedule.index_at(0.4);
    const int swing = walk.schedule.phase(phase).mode.left ? 1 : 0;
    const double lift_off_s = walk.schedule.phase(phase).start_s;
    const double hip_m = walk.state[0] + 0.5 * (lift_off_s - 0.5 * walk.gait.single_support_s - 0.4);
    EXPECT_NEAR(walk.reference.evaluate(lift_off_s, phase).foot_position_W_m[2 * swing], hip_m, 1e-12)
        << "standing since " << standing_since_s;
  }
}

TEST(Reference, NominalJointsStandTheFeetBelowTheHip) {
  const Walk walk({});
  model::KinematicsTerms<double> feet;
  model::StateVector state = walk.at(0.4).state;
  testing_support::amber3m().kinematics(state.data(), feet);
  for (const int foot : {0, 1}) {
    EXPECT_NEAR(feet.foot_position[2 * foot], state[0], 1e-9);
    EXPECT_NEAR(feet.foot_position[2 * foot + 1], 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace stilt::gait
