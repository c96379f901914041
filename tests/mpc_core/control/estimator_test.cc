#include "mpc_core/control/estimator.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "mpc_core/gait/reference.h"
#include "mpc_core/gait/swing.h"
#include "tests/mpc_core/control/relative_feet.h"
#include "tests/mpc_core/control/sample_plan.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

using model::ContactMode;
using model::FeetVector;
using model::kFirstJoint;
using model::kLeft;
using model::kPositions;
using model::kRight;
using model::StateVector;
using testing_support::reading_of;
using testing_support::RelativeFeet;

constexpr double kTick_s = 0.001;
constexpr double kStep_s = 0.4;
constexpr double kBlend_s = 0.02;
constexpr double kExact = 1e-9;
constexpr ContactMode kLeftOnly{true, false};
constexpr ContactMode kRightOnly{false, true};
constexpr ContactMode kBoth{true, true};

/// A walk as pure kinematics. The hip bobs along at constant speed, stance feet never move, swing feet leave
/// and arrive some time from the switches. Exact positions and velocities.
class KinematicWalk {
 public:
  KinematicWalk(const model::RobotModel& robot, double speed_m_s) : robot_(robot), speed_m_s_(speed_m_s) {}

  [[nodiscard]] static ContactMode mode(long long tick) {
    return tick / kTicksAStep % 2 == 0 ? kLeftOnly : kRightOnly;
  }

  [[nodiscard]] StateVector state(long long tick) const {
    const double time_s = static_cast<double>(tick) * kTick_s;
    StateVector state = StateVector::Zero();
    state[0] = speed_m_s_ * time_s + 0.01 * std::sin(7.0 * time_s);
    state[1] = 0.78 + 0.01 * std::cos(5.0 * time_s);
    state[2] = 0.05 * std::sin(3.0 * time_s);
    state[kPositions] = speed_m_s_ + 0.07 * std::cos(7.0 * time_s);
    state[kPositions + 1] = -0.05 * std::sin(5.0 * time_s);
    state[kPositions + 2] = 0.15 * std::cos(3.0 * time_s);
    for (int foot = 0; foot < model::kFeet; ++foot) pose_leg(foot, tick, state);
    return state;
  }

 private:
  static constexpr long long kTicksAStep = 400;
  static constexpr double kStill_s = 0.05;  ///< at both ends of a swing; longer than the blend

  /// World motion of a foot: it stands during even steps (left) or odd steps (right).
  void foot_motion(int foot, long long tick, gait::Motion& x, gait::Motion& z) const {
    const long long step = tick / kTicksAStep;
    const double in_step_s = static_cast<double>(tick % kTicksAStep) * kTick_s;
    const bool stands = step % 2 == foot;
    const long long stance = stands ? step : step - 1;  // the step that it stands in, or stood in last
    const double length_m = speed_m_s_ * kStep_s;
    const double here_m = length_m * (static_cast<double>(stance) + 0.5);
    x = {here_m, 0.0, 0.0};
    z = {0.0, 0.0, 0.0};
    if (stands || in_step_s <= kStill_s) return;
    const double swing_s = kStep_s - 2.0 * kStill_s;
    const double s = std::min((in_step_s - kStill_s) / swing_s, 1.0);
    x = gait::minimum_jerk(here_m, here_m + 2.0 * length_m, s, swing_s);
    if (s < 1.0) z = gait::swing_height(0.06, 0.0, s, swing_s);
  }

  /// Joint angles and rates that put the foot where it is.
  void pose_leg(int foot, long long tick, StateVector& state) const {
    gait::Motion x{};
    gait::Motion z{};
    foot_motion(foot, tick, x, z);
    const int joint = kFirstJoint + 2 * foot;
    const Eigen::Vector2d angles =
        gait::leg_angles(x.position - state[0], z.position - state[1], robot_.constants.thigh_length_m,
                         robot_.constants.shin_length_m);
    state[joint] = angles[0] - state[2];
    state[joint + 1] = angles[1];
    model::KinematicsTerms<double> terms;
    robot_.kinematics(state.data(), terms);
    Eigen::Matrix2d jacobian;
    Eigen::Vector2d missing(x.velocity, z.velocity);
    for (int axis = 0; axis < 2; ++axis) {
      const double* row = terms.foot_jacobian[2 * foot + axis];
      for (int i = 0; i < kFirstJoint; ++i) missing[axis] -= row[i] * state[kPositions + i];
      jacobian.row(axis) << row[joint], row[joint + 1];
    }
    state.segment<2>(kPositions + joint) = jacobian.inverse() * missing;
  }

  const model::RobotModel& robot_;
  double speed_m_s_;
};

class EstimatorTest : public ::testing::Test {
 protected:
  void configure(double blend_s) { estimator_.configure(robot_, EstimatorParameters{blend_s}); }

  const model::RobotModel& robot_ = testing_support::amber3m();
  Estimator estimator_;
};

TEST_F(EstimatorTest, StandingStillTheBaseIsWhereItStarted) {
  configure(kBlend_s);
  StateVector state = gait::standing_state(robot_.constants, 0.8, 0.1, 0.15, true);
  state[0] = 3.25;
  estimator_.reset(reading_of(state, 0.0), state[0]);
  for (int tick = 0; tick < 100; ++tick) {
    const StateVector estimate = estimator_.update(reading_of(state, tick * kTick_s), kBoth);
    ASSERT_LT((estimate - state).cwiseAbs().maxCoeff(), kExact);
  }
}

TEST_F(EstimatorTest, AnglesAndTheirRatesAreTheSensors) {
  configure(kBlend_s);
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  const StateVector state = testing_support::random_state(random);
  estimator_.reset(reading_of(state, 0.0), 0.0);
  const StateVector estimate = estimator_.update(reading_of(state, 0.0), kBoth);
  for (int i = model::kFirstAngle; i < kPositions; ++i) {
    EXPECT_EQ(estimate[i], state[i]);
    EXPECT_EQ(estimate[kPositions + i], state[kPositions + i]);
  }
}

TEST_F(EstimatorTest, AWalkWithoutSlipIsFollowedExactlyForAMinute) {
  for (const double speed_m_s : {-0.4, 0.0, 0.5, 0.8}) {
    configure(kBlend_s);
    const KinematicWalk walk(robot_, speed_m_s);
    const StateVector start = walk.state(0);
    estimator_.reset(reading_of(start, 0.0), start[0]);
    double worst = 0.0;
    for (long long tick = 0; tick < 60000; ++tick) {
      const StateVector truth = walk.state(tick);
      const SensorReading reading = reading_of(truth, static_cast<double>(tick) * kTick_s);
      const StateVector estimate = estimator_.update(reading, KinematicWalk::mode(tick));
      worst = std::max(worst, (estimate - truth).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, kExact) << "at " << speed_m_s << " m/s";
  }
}

TEST_F(EstimatorTest, TrustMovesLinearlyFromTheOldStanceFootToTheNewOne) {
  configure(kBlend_s);
  constexpr std::uint64_t kSeed = 17;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  const StateVector state = testing_support::random_state(random);  // both feet move, differently
  const RelativeFeet feet(robot_, state);
  double time_s = 0.0;
  estimator_.reset(reading_of(state, time_s), 0.0);
  for (; time_s < 0.1; time_s += kTick_s) (void)estimator_.update(reading_of(state, time_s), kLeftOnly);
  EXPECT_NEAR(estimator_.update(reading_of(state, time_s), kLeftOnly)[kPositions], feet.vx_m_s(kLeft),
              kExact);
  for (int tick = 1; tick <= 30; ++tick) {
    time_s += kTick_s;
    const StateVector estimate = estimator_.update(reading_of(state, time_s), kRightOnly);
    const double s = std::min(tick * kTick_s / kBlend_s, 1.0);
    EXPECT_NEAR(estimate[kPositions], (1.0 - s) * feet.vx_m_s(kLeft) + s * feet.vx_m_s(kRight), kExact);
    EXPECT_NEAR(estimate[kPositions + 1], (1.0 - s) * feet.vz_m_s(kLeft) + s * feet.vz_m_s(kRight), kExact);
    EXPECT_NEAR(estimate[1], (1.0 - s) * feet.height_m(kLeft) + s * feet.height_m(kRight), kExact);
  }
}

TEST_F(EstimatorTest, PositionIsContinuousAtASwitch) {
  configure(kBlend_s);
  constexpr std::uint64_t kSeed = 18;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  StateVector state = testing_support::random_state(random);
  estimator_.reset(reading_of(state, 0.0), 1.0);
  const auto moved = [&](int tick) {
    StateVector now = state;
    now.head<kPositions>() += tick * kTick_s * state.tail<kPositions>();
    return now;
  };
  double anchor_m = 0.0;
  for (int tick = 0; tick < 50; ++tick) {
    const StateVector now = moved(tick);
    const StateVector estimate = estimator_.update(reading_of(now, tick * kTick_s), kLeftOnly);
    anchor_m = estimate[0] + RelativeFeet(robot_, now).x_m(kLeft);
  }
  // At the switch both feet agree on x, whatever the weights: the new foot is anchored by the old one.
  const StateVector now = moved(50);
  const StateVector estimate = estimator_.update(reading_of(now, 50 * kTick_s), kRightOnly);
  EXPECT_NEAR(estimate[0], anchor_m - RelativeFeet(robot_, now).x_m(kLeft), kExact);
}

TEST_F(EstimatorTest, WithoutBlendTrustMovesAtOnce) {
  configure(0.0);
  constexpr std::uint64_t kSeed = 19;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  const StateVector state = testing_support::random_state(random);
  const RelativeFeet feet(robot_, state);
  estimator_.reset(reading_of(state, 0.0), 0.0);
  const StateVector left = estimator_.update(reading_of(state, 0.0), kLeftOnly);
  EXPECT_NEAR(left[1], feet.height_m(kLeft), kExact);
  EXPECT_NEAR(left[kPositions], feet.vx_m_s(kLeft), kExact);
  const StateVector right = estimator_.update(reading_of(state, kTick_s), kRightOnly);
  EXPECT_NEAR(right[1], feet.height_m(kRight), kExact);
  EXPECT_NEAR(right[kPositions], feet.vx_m_s(kRight), kExact);
  EXPECT_NEAR(right[0], left[0], kExact);
}

TEST_F(EstimatorTest, ALateTickOrAStandingClockDoesNoHarm) {
  configure(kBlend_s);
  const KinematicWalk walk(robot_, 0.5);
  const StateVector start = walk.state(0);
  estimator_.reset(reading_of(start, 0.0), start[0]);
  for (long long tick = 0; tick < 2000; tick += tick % 100 == 99 ? 11 : 1) {
    const StateVector truth = walk.state(tick);
    const SensorReading reading = reading_of(truth, static_cast<double>(tick) * kTick_s);
    (void)estimator_.update(reading, KinematicWalk::mode(tick));
    const StateVector estimate = estimator_.update(reading, KinematicWalk::mode(tick));
    ASSERT_LT((estimate - truth).cwiseAbs().maxCoeff(), kExact) << "tick " << tick;
  }
}

/// Both feet on the ground and at rest, but for the sensors' velocities.
class VelocityFilterTest : public EstimatorTest {
 protected:
  static constexpr double kFilter_s = 0.005;

  void start() {
    constexpr double kUnbounded_m_s2 = 1e6;
    estimator_.configure(robot_, {.blend_s = kBlend_s,
                                  .velocity_filter_s = kFilter_s,
                                  .velocity_correction_max_m_s2 = kUnbounded_m_s2});
    standing_ = gait::standing_state(robot_.constants, 0.8, 0.0, 0.15, true);
    estimator_.reset(reading_of(standing_, 0.0), 0.0);
  }
  /// Estimate of the base's velocity after a tick in which the feet show `measured` and the plan changes it
  /// by `planned`, both forward.
  double speed_after(int tick, double measured_m_s, double planned_m_s) {
    const BaseVelocity change(planned_m_s, 0.0);
    return estimator_.update(reading_of(moving(measured_m_s), tick * kTick_s), kBoth, &change)[kPositions];
  }
  /// Both feet at rest while the base moves forward.
  [[nodiscard]] StateVector moving(double speed_m_s) const {
    StateVector state = standing_;
    model::KinematicsTerms<double> feet;
    robot_.kinematics(state.data(), feet);
    for (int foot = 0; foot < model::kFeet; ++foot) {
      Eigen::Matrix2d leg;
      for (int row = 0; row < 2; ++row) {
        for (int joint = 0; joint < 2; ++joint) {
          leg(row, joint) = feet.foot_jacobian[2 * foot + row][kFirstJoint + 2 * foot + joint];
        }
      }
      state.segment<2>(kPositions + kFirstJoint + 2 * foot) =
          leg.inverse() * Eigen::Vector2d(-speed_m_s, 0.0);
    }
    return state;
  }

  StateVector standing_;
};

TEST_F(VelocityFilterTest, AMeasuredStepIsReachedExponentiallyWithTheTimeConstant) {
  start();
  for (int tick = 1; tick <= 30; ++tick) {
    const double expected = 1.0 - std::exp(-tick * kTick_s / kFilter_s);
    EXPECT_NEAR(speed_after(tick, 1.0, 0.0), expected, 1e-9) << "tick " << tick;
  }
}

TEST_F(VelocityFilterTest, ThePitchRateIsTheSensorsAtOnce) {
  start();
  StateVector state = standing_;
  state[kPositions + 2] = 1.3;
  const BaseVelocity none = BaseVelocity::Zero();
  EXPECT_EQ(estimator_.update(reading_of(state, kTick_s), kBoth, &none)[kPositions + 2], 1.3);
}

TEST_F(VelocityFilterTest, TheLinearVelocityIsCorrectedAtTheLargestRateAtMost) {
  constexpr double kMost_m_s2 = 14.0;
  estimator_.configure(
      robot_,
      {.blend_s = kBlend_s, .velocity_filter_s = kFilter_s, .velocity_correction_max_m_s2 = kMost_m_s2});
  standing_ = gait::standing_state(robot_.constants, 0.8, 0.0, 0.15, true);
  estimator_.reset(reading_of(standing_, 0.0), 0.0);
  StateVector state = standing_;
  state.tail<model::kJoints>() << 6.0, 0.0, 6.0, 0.0;  // both thighs swing: metres per second at the feet
  const BaseVelocity none = BaseVelocity::Zero();
  BaseVelocity before = none;
  for (int tick = 1; tick <= 20; ++tick) {
    const StateVector estimate = estimator_.update(reading_of(state, tick * kTick_s), kBoth, &none);
    const BaseVelocity now = estimate.segment<2>(kPositions);
    EXPECT_NEAR(std::abs(now[0] - before[0]), kMost_m_s2 * kTick_s, 1e-12) << "tick " << tick;
    EXPECT_LE(std::abs(now[1] - before[1]), kMost_m_s2 * kTick_s + 1e-12) << "tick " << tick;
    before = now;
  }
}

TEST_F(VelocityFilterTest, AMotionThatFollowsThePlanIsNotDelayed) {
  start();
  double speed_m_s = 0.0;
  for (int tick = 1; tick <= 200; ++tick) {
    const double change_m_s = tick == 100 ? -1.5 : 0.01;  // a touch-down among steady acceleration
    speed_m_s += change_m_s;
    EXPECT_NEAR(speed_after(tick, speed_m_s, change_m_s), speed_m_s, 1e-9) << "tick " << tick;
  }
}

TEST_F(VelocityFilterTest, WithoutAPlanTheMeasuredVelocityIsTaken) {
  start();
  (void)speed_after(1, 1.0, 0.0);
  EXPECT_NEAR(estimator_.update(reading_of(moving(0.7), 2 * kTick_s), kBoth)[kPositions], 0.7, 1e-9);
  EXPECT_NEAR(speed_after(3, 0.7, 0.0), 0.7, 1e-9) << "and the filter goes on from there";
}

}  // namespace
}  // namespace stilt::control
