/// The impact map against the impacts of published gaits. Their model of the robot is not ours, so that they
/// confirm its parameters. Above all they confirm the torso's centre of mass, which has two published values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "mpc_core/model/robot.h"
#include "tests/robots.h"

namespace stilt::model {
namespace {

constexpr double kTorsoMass_kg = 13.0;  // of amber3m; nine of the gaits were made with 13.122 kg

/// One line of the data: the right foot lands.
struct PublishedImpact {
  std::string gait;
  double torso_mass_kg;
  double before[kStates];
  double velocity_after[kPositions];
};

/// The published impacts, without malformed lines: their number is a claim below.
std::vector<PublishedImpact> published_impacts() {
  std::ifstream file(STILT_TEST_DATA "/published_amber3m_impacts.txt");
  std::vector<PublishedImpact> impacts;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream in(line);
    PublishedImpact impact;
    in >> impact.gait >> impact.torso_mass_kg;
    for (double& value : impact.before) in >> value;
    for (double& value : impact.velocity_after) in >> value;
    if (in) impacts.push_back(impact);
  }
  return impacts;
}

/// Exchanges the legs of a position or of a velocity.
void exchange_legs(double* positions) {
  constexpr int kLegJoints = kJoints / kFeet;
  double* left = positions + kPositions - kJoints;
  std::swap_ranges(left, left + kLegJoints, left + kLegJoints);
}

/// Largest difference of the velocities after the impact of that foot from the published ones, m/s or rad/s.
double largest_error(const RobotModel& robot, PublishedImpact published, int foot) {
  if (foot == kLeft) {
    exchange_legs(published.before);
    exchange_legs(published.before + kPositions);
    exchange_legs(published.velocity_after);
  }
  ImpactTerms<double> impact;
  robot.impact({.left = foot == kLeft, .right = foot == kRight}, published.before,
               robot.constants.joint_parameters, impact);
  double largest = 0.0;
  for (int i = 0; i < kPositions; ++i) {
    largest = std::max(largest, std::abs(impact.velocity_after[i] - published.velocity_after[i]));
  }
  return largest;
}

TEST(PublishedImpacts, AreElevenOfWhichTwoHaveOurTorsoMass) {
  const std::vector<PublishedImpact> impacts = published_impacts();
  EXPECT_EQ(impacts.size(), 11U);
  EXPECT_EQ(std::ranges::count(impacts, kTorsoMass_kg, &PublishedImpact::torso_mass_kg), 2);
}

/// Measured: 4.3e-5 and 4.6e-5.
TEST(PublishedImpacts, OfTheSameTorsoMassAreAmber3ms) {
  for (const PublishedImpact& published : published_impacts()) {
    if (published.torso_mass_kg != kTorsoMass_kg) continue;
    for (const int foot : {kLeft, kRight}) {
      EXPECT_LT(largest_error(testing_support::amber3m(), published, foot), 1e-4)
          << published.gait << " foot " << foot;
    }
  }
}

/// Measured: at most 0.0074 under amber3m, by the 0.122 kg; 0.043 to 0.112 under amber3m_2020.
TEST(PublishedImpacts, FitAmber3mInEveryGaitAndAmber3m2020InNone) {
  for (const PublishedImpact& published : published_impacts()) {
    for (const int foot : {kLeft, kRight}) {
      EXPECT_LT(largest_error(testing_support::amber3m(), published, foot), 0.01)
          << published.gait << " foot " << foot;
      EXPECT_GT(largest_error(testing_support::amber3m_2020(), published, foot), 0.04)
          << published.gait << " foot " << foot;
    }
  }
}

}  // namespace
}  // namespace stilt::model
