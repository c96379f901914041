// Faults that show only when a tick is compared with the ones before: in the loop, with the commands that it
// gave.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/firmware/control_loop/rig.h"

namespace stilt::control_loop {
namespace {

using supervisor::Fault;
using supervisor::RequestKind;
using supervisor::State;
using testing::Rig;

class PlausibilityTest : public ::testing::Test {
 protected:
  /// Ticks of drivers that give the torque they were asked for, but for one, and a torso sensor at 1 kHz.
  void run(int ticks) {
    for (int i = 0; i < ticks && rig->state() != State::fault; ++i) {
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        rig->joints.readings[joint].torque_Nm =
            joint == dead_joint ? 0.0 : rig->joints.commands[joint].torque_Nm;
      }
      rig->joints.base.time_ns = rig->now_ns();
      rig->run(1);
      ++ticks_run;
    }
  }

  void expect(Fault fault, int joint) {
    EXPECT_TRUE(rig->decision().latched.has(fault)) << name(fault);
    bool reported = false;
    for (const Event& event : rig->take(Event::Kind::fault)) {
      if (event.fault != fault) continue;
      reported = true;
      EXPECT_EQ(event.found.joint, joint);
      ASSERT_TRUE(std::isfinite(event.found.value) && std::isfinite(event.found.limit));
      if (fault == Fault::hip_height_limit) {
        EXPECT_LT(event.found.value, event.found.limit);
      } else {
        EXPECT_GT(std::abs(event.found.value), event.found.limit);
      }
    }
    EXPECT_TRUE(reported);
    EXPECT_TRUE(rig->only_damps());
  }

  std::unique_ptr<Rig> rig = std::make_unique<Rig>();
  std::size_t dead_joint = hal::kJoints;
  int ticks_run = 0;
};

TEST_F(PlausibilityTest, ARobotThatDoesWhatItIsAskedHasNoFault) {
  rig->stand();
  run(1000);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_TRUE(rig->decision().latched.empty());
}

TEST_F(PlausibilityTest, ADriverThatGivesNoTorqueIsFoundWithItsJoint) {
  rig->stand();
  run(100);
  ASSERT_GT(std::abs(rig->joints.commands[1].torque_Nm),
            1.1 * rig->configuration.supervisor.torque_mismatch_Nm)
      << "a knee carries";
  dead_joint = 1;
  ticks_run = 0;
  run(1000);
  expect(Fault::torque_mismatch, 1);
  EXPECT_LT(ticks_run, 600);
}

TEST_F(PlausibilityTest, AnEncoderThatJumpsIsFoundInTheSameTick) {
  rig->stand();
  run(100);
  rig->joints.readings[2].position_rad += 1.2 * rig->configuration.supervisor.encoder_jump_rad;
  ticks_run = 0;
  run(5);
  EXPECT_EQ(ticks_run, 1);
  expect(Fault::encoder_jump, 2);
}

TEST_F(PlausibilityTest, AJointMovedByHandBetweenTwoStancesIsNoJump) {
  rig->stand();
  rig->fall_and_get_ready();
  rig->joints.readings[2].position_rad += 2 * rig->configuration.supervisor.encoder_jump_rad;
  rig->ask(RequestKind::stand);
  run(500);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(PlausibilityTest, ATorsoSensorWhoseRateContradictsItsAngleIsFound) {
  rig->stand();
  run(100);
  rig->joints.base.pitch_rate_rad_s = 0.8;  // and the angle stays
  ticks_run = 0;
  run(1000);
  expect(Fault::torso_sensor_implausible, -1);
  EXPECT_LT(ticks_run, 300);
}

TEST_F(PlausibilityTest, LegsThatFoldUnderAnUprightTorsoAreFoundBeforeTheHipIsDown) {
  rig->stand();
  run(100);
  const double speed_rad_s = 4.0;
  for (int i = 0; i < 1000 && rig->state() != State::fault; ++i) {
    for (const std::size_t knee : {1U, 3U}) {
      rig->joints.readings[knee].position_rad += 1e-3 * speed_rad_s;
      rig->joints.readings[knee].velocity_rad_s = speed_rad_s;
      rig->joints.readings[knee - 1].position_rad -= 0.5e-3 * speed_rad_s;
      rig->joints.readings[knee - 1].velocity_rad_s = -0.5 * speed_rad_s;
    }
    run(1);
  }
  expect(Fault::hip_height_limit, -1);
  EXPECT_LT(rig->joints.readings[1].position_rad, 2.5) << "of a travel of 2.4 rad";
}

TEST_F(PlausibilityTest, AJointThatStaysFarFromThePlanIsFound) {
  rig->stand();
  rig->plan_once_more([](control::Plan& plan) {
    for (int node = 0; node < plan.nodes; ++node) plan.node[node].state[model::kFirstJoint + 2] += 1.2;
  });
  run(200);
  expect(Fault::following_error, 2);
}

class SittingPlausibilityTest : public PlausibilityTest {
 protected:
  void begin_to_sit() {
    rig->stand();
    rig->ask(RequestKind::sit);
    run(100);
    ASSERT_EQ(rig->state(), State::sit);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks && rig->state() != State::fault; ++i) {
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        const hal::JointCommand& command = rig->joints.commands[joint];
        hal::JointReading& reading = rig->joints.readings[joint];
        const double law_Nm = command.torque_Nm +
                              command.kp_Nm_rad * (command.position_rad - reading.position_rad) -
                              command.kd_Nms_rad * reading.velocity_rad_s;
        reading.torque_Nm = joint == dead_joint ? 0.0 : law_Nm;
        largest_Nm = std::max(largest_Nm, std::abs(law_Nm));
      }
      rig->run(1);
      ++ticks_run;
    }
  }
  double largest_Nm = 0;  ///< that any joint gave
};

TEST_F(SittingPlausibilityTest, ARobotThatSitsDownHasNoFault) {
  begin_to_sit();
  run(static_cast<int>(1000 * rig->configuration.supervisor.sit_s) + 100);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_TRUE(rig->decision().latched.empty());
}

TEST_F(SittingPlausibilityTest, AJointThatIsHeldIsFoundWhileItSitsDown) {
  begin_to_sit();
  rig->held_joint = 1;
  ticks_run = 0;
  run(2000);
  expect(Fault::following_error, 1);
  EXPECT_LT(ticks_run, 1500);
  EXPECT_GT(largest_Nm, 40.0) << "more than damping gives, see docs/hazards.md";
  EXPECT_LE(largest_Nm, rig->robot->constants.torque_limit_Nm[1] + 1e-9);
}

TEST_F(SittingPlausibilityTest, AnEncoderThatJumpsIsFoundWhileItSitsDown) {
  begin_to_sit();
  rig->held_joint = 2;
  rig->joints.readings[2].position_rad += 1.2 * rig->configuration.supervisor.encoder_jump_rad;
  ticks_run = 0;
  run(5);
  EXPECT_EQ(ticks_run, 1);
  expect(Fault::encoder_jump, 2);
}

TEST_F(SittingPlausibilityTest, ADriverThatGivesNoTorqueIsFoundWhileItSitsDown) {
  begin_to_sit();
  rig->held_joint = 1;
  dead_joint = 1;
  run(2000);
  expect(Fault::torque_mismatch, 1);
}

TEST_F(SittingPlausibilityTest, ADriverThatIsIdleIsFoundWhileItSitsDown) {
  begin_to_sit();
  rig->joints.readings[3].state = hal::DriverState::idle;
  run(5);
  EXPECT_TRUE(rig->decision().latched.has(Fault::driver_not_enabled));
  EXPECT_TRUE(rig->only_damps());
}

}  // namespace
}  // namespace stilt::control_loop
