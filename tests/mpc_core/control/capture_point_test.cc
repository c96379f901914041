#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/robots/robots.h"
#include "mpc_core/control/fall_catcher.h"
#include "tests/codegen/model/mujoco_robot.h"
#include "tests/mpc_core/control/sample_plan.h"
#include "tests/robots.h"

namespace stilt::control {
namespace {

/// The capture point of MuJoCo's centre of mass, velocity and angular momentum, for any posture and motion.
TEST(CapturePoint, IsThatOfTheWholeBody) {
  constexpr std::uint64_t kSeed = 7;
  std::mt19937_64 random(kSeed);
  for (const char* name : {"amber3m", "rabbit"}) {
    const model::RobotModel& robot = *testing_support::find_robot(name);
    testing_support::MujocoRobot mujoco(robots::find(name).value()->tree);
    for (int trial = 0; trial < 50; ++trial) {
      const model::StateVector state = testing_support::random_state(random);
      const double none[2 * model::kJoints] = {};
      mujoco.forward(state.data(), none, none);
      const double mass_kg = mujoco.mass_kg();
      const double* com_m = mujoco.centre_of_mass_m();
      const double about_ground =
          mujoco.angular_momentum()[1] + com_m[2] * mass_kg * mujoco.velocity_m_s()[0];
      const double expected_m =
          com_m[0] + about_ground / (mass_kg * com_m[2]) * std::sqrt(com_m[2] / model::kGravity_m_s2);
      EXPECT_NEAR(capture_point_x_m(robot, robot.constants.joint_parameters, state), expected_m, 1e-9)
          << name << ", seed " << kSeed << ", trial " << trial;
    }
  }
}

}  // namespace
}  // namespace stilt::control
