#include "firmware/controller/torque_cycle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/realtime/allocation_counter.h"
#include "tests/firmware/controller/rig.h"

namespace stilt::controller {
namespace {

using supervisor::Fault;
using supervisor::RequestKind;
using supervisor::Rung;
using supervisor::State;
using testing::Rig;

class TorqueCycleTest : public ::testing::Test {
 protected:
  TorqueCycleTest() : rig(std::make_unique<Rig>()) {}
  std::unique_ptr<Rig> rig;
};

bool only_damps(const hal::JointCommands& commands) {
  for (const hal::JointCommand& command : commands) {
    if (command.kp_Nm_rad != 0 || command.torque_Nm != 0 || command.velocity_rad_s != 0) return false;
  }
  return true;
}

/// Events of a kind that wait in the ring.
std::vector<Event> take(Rig& rig, Event::Kind kind) {
  std::vector<Event> events;
  while (const Event* event = rig.mail.events.front()) {
    if (event->kind == kind) events.push_back(*event);
    rig.mail.events.pop();
  }
  return events;
}

TEST_F(TorqueCycleTest, NothingIsSentBeforeSomebodyAsks) {
  rig->run(200);
  EXPECT_EQ(rig->state(), State::idle);
  EXPECT_EQ(rig->joints.writes, 0);
  EXPECT_EQ(rig->joints.disables, 0);
  EXPECT_EQ(rig->drivers.steps, 0);
}

TEST_F(TorqueCycleTest, DriversThatCameUpAreDampedAndNoMore) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(50);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_EQ(rig->drivers.begun, 1);
  EXPECT_GT(rig->joints.writes, 40);
  EXPECT_TRUE(only_damps(rig->joints.commands));
}

TEST_F(TorqueCycleTest, ADriverThatCannotBeBroughtUpIsNamedAndEndsInAFault) {
  rig->drivers.outcome = {.failed = true,
                          .joint = 3,
                          .stage = hal::bring_up::Stage::failed,
                          .failure = hal::bring_up::Failure::not_home};
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(10);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_EQ(rig->drivers.steps, 1) << "the others are not asked any further";
  const auto events = take(*rig, Event::Kind::bring_up_failed);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].joint, 3);
  EXPECT_EQ(events[0].failure, hal::bring_up::Failure::not_home);
}

TEST_F(TorqueCycleTest, StandingTorquesAreThoseOfTheTorqueLawOnTheNewestPlan) {
  rig->stand();
  const control::Plan& plan = rig->mail.plans.newest();
  control::TorqueLoop law;
  law.configure(*rig->robot, rig->configuration);
  control::SensorReading reading;
  reading.time_s = rig->cycle.time_s();
  reading.joint_position_rad = rig->standing.segment<model::kJoints>(model::kFirstJoint);
  const model::StateVector estimate =
      Eigen::Map<const model::StateVector>(rig->record.estimated_state.data());
  const control::TorqueCommand wanted = law.tick_with_state(reading, estimate, plan);
  ASSERT_EQ(wanted.status, control::TorqueStatus::tracking);
  double carried_Nm = 0;
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    EXPECT_EQ(rig->joints.commands[i].torque_Nm, wanted.torque_Nm[static_cast<int>(i)]);
    EXPECT_EQ(rig->joints.commands[i].kp_Nm_rad, 0) << "the law is evaluated here, not in the driver";
    EXPECT_EQ(rig->joints.commands[i].kd_Nms_rad, 0);
    carried_Nm += std::abs(wanted.torque_Nm[static_cast<int>(i)]);
  }
  EXPECT_GT(carried_Nm, 10.0) << "the legs carry the body";
  EXPECT_NEAR(estimate[1], rig->configuration.reference.base_height_m, 1e-3);
}

TEST_F(TorqueCycleTest, ThePitchIsCarriedOnWithItsRateUntilTheNextFrame) {
  constexpr int kPitch = model::kFirstAngle;
  rig->base.reading = {.pitch_rad = 0.1, .pitch_rate_rad_s = 2.0, .time_ns = rig->now_ns()};
  rig->run(1);
  EXPECT_DOUBLE_EQ(rig->record.estimated_state[kPitch], 0.1) << "fresh";
  rig->run(1);
  EXPECT_NEAR(rig->record.estimated_state[kPitch], 0.102, 1e-12);
  rig->run(50);
  EXPECT_NEAR(rig->record.estimated_state[kPitch], 0.12, 1e-12) << "for 10 ms at most";
}

TEST_F(TorqueCycleTest, TheTorqueLawTakesOverGradually) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(3);
  rig->ask(RequestKind::stand);
  rig->run(30);
  double before_Nm = 0;
  for (int part = 0; part < 5; ++part) {
    rig->run(250);
    const double torque_Nm = std::abs(rig->joints.commands[1].torque_Nm);
    EXPECT_GT(torque_Nm, before_Nm) << part;
    before_Nm = torque_Nm;
  }
}

TEST_F(TorqueCycleTest, AnEncoderThatStandsStillIsAFaultOnceTheTorqueLawIsInCommand) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(3);
  // Encoders that stick while a joint moved: plans start from that speed.
  for (hal::JointReading& reading : rig->joints.readings) {
    reading.velocity_rad_s = 0.9;
    reading.frozen = 1000;
  }
  rig->ask(RequestKind::stand);
  rig->run(1000);
  EXPECT_EQ(rig->state(), State::stand) << "still taking over";
  rig->run(1000);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::stale_encoder));
}

TEST_F(TorqueCycleTest, StandingUpWaitsForTheStandingPose) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(3);
  const double knee_rad = rig->joints.readings[1].position_rad;
  rig->joints.readings[1].position_rad = knee_rad + 0.3;
  rig->ask(RequestKind::stand);
  rig->run(100);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_TRUE(only_damps(rig->joints.commands));
  EXPECT_EQ(take(*rig, Event::Kind::waits_for_pose).size(), 1u);
  rig->joints.readings[1].position_rad = knee_rad;
  rig->joints.readings[0].velocity_rad_s = 3.0;
  rig->run(10);
  EXPECT_EQ(rig->state(), State::ready) << "still moving";
  rig->joints.readings[0].velocity_rad_s = 0.0;
  rig->run(10);
  EXPECT_EQ(rig->state(), State::stand);
}

TEST_F(TorqueCycleTest, LeavingTheStandingPoseWhileStandingUpEndsDampedAndIsTold) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(3);
  rig->ask(RequestKind::stand);
  rig->run(500);
  ASSERT_EQ(rig->state(), State::stand);
  rig->joints.readings[1].position_rad += rig->configuration.supervisor.stance_margin_rad + 0.01;
  rig->run(2);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_TRUE(only_damps(rig->joints.commands));
  EXPECT_EQ(take(*rig, Event::Kind::lost_stance).size(), 1u);
  EXPECT_TRUE(rig->decision().latched.empty());
}

TEST_F(TorqueCycleTest, AWalkIsPlannedWithTheSpeedAskedFor) {
  rig->stand();
  rig->ask(RequestKind::walk, 0.3);
  rig->run(2);
  EXPECT_EQ(rig->state(), State::walk);
  const PlanningRequest& request = rig->mail.requests.newest();
  EXPECT_EQ(request.command.kind, gait::GaitKind::walk);
  EXPECT_EQ(request.command.speed_m_s, 0.3);
  EXPECT_EQ(request.session, 1u);
}

TEST_F(TorqueCycleTest, ASensorThatIsNotANumberDampsAtOnceWithFiniteCommands) {
  rig->stand();
  rig->base.reading.pitch_rad = std::numeric_limits<double>::quiet_NaN();
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(only_damps(rig->joints.commands));
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_TRUE(std::isfinite(command.position_rad) && std::isfinite(command.kd_Nms_rad));
  }
}

TEST_F(TorqueCycleTest, APlanThatIsNotANumberNeverReachesTheJoints) {
  rig->stand();
  rig->planning = false;
  control::Plan& bad = rig->mail.plans.writer();
  bad = rig->mail.plans.newest();
  for (int k = 0; k < bad.nodes; ++k) bad.node[static_cast<std::size_t>(k)].input.setConstant(NAN);
  rig->mail.plans.publish();
  rig->run(1);
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_TRUE(std::isfinite(command.torque_Nm));
  }
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::not_finite));
  EXPECT_TRUE(only_damps(rig->joints.commands));
}

TEST_F(TorqueCycleTest, AfterALatchedFaultNothingButDampingIsSentWhateverIsAsked) {
  rig->stand();
  rig->stop.state = hal::EmergencyStopState::pressed;
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(only_damps(rig->joints.commands)) << "in the very tick";
  rig->stop.state = hal::EmergencyStopState::released;
  for (const RequestKind kind :
       {RequestKind::stand, RequestKind::walk, RequestKind::calibrate, RequestKind::sit}) {
    rig->ask(kind);
    rig->run(20);
    EXPECT_EQ(rig->state(), State::fault);
    EXPECT_TRUE(only_damps(rig->joints.commands));
  }
  rig->ask(RequestKind::reset);
  rig->run(20);
  EXPECT_EQ(rig->state(), State::idle);
  EXPECT_GE(rig->buses.restored, 1);
}

TEST_F(TorqueCycleTest, APlanFromBeforeTheLastFallIsNotFollowed) {
  rig->stand();
  rig->stop.state = hal::EmergencyStopState::pressed;
  rig->run(10);
  rig->stop.state = hal::EmergencyStopState::released;
  rig->ask(RequestKind::reset);
  rig->run(10);
  rig->ask(RequestKind::calibrate);
  rig->run(5);
  rig->planning = false;
  rig->ask(RequestKind::stand);
  rig->run(20);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_EQ(rig->mail.requests.newest().session, 2u);
  EXPECT_EQ(rig->rung(), Rung::hold) << "the old plan has not ended yet, but belongs to another place";
}

TEST_F(TorqueCycleTest, BusErrorsAreNoticedInTheTickTheyAreCounted) {
  rig->stand();
  rig->run(5);
  EXPECT_FALSE(rig->decision().present.has(Fault::bus_error));
  rig->buses.error_count += 3;
  rig->run(1);
  EXPECT_TRUE(rig->decision().present.has(Fault::bus_error));
  rig->run(1);
  EXPECT_FALSE(rig->decision().present.has(Fault::bus_error));
}

TEST_F(TorqueCycleTest, ALongTickIsAFault) {
  rig->stand();
  rig->late_ns = 20'000'000;
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::torque_loop_stalled));
}

TEST_F(TorqueCycleTest, FaultsAndStatesAreTold) {
  rig->stand();
  const auto states = take(*rig, Event::Kind::state);
  ASSERT_GE(states.size(), 4u);
  EXPECT_EQ(states.back().state, State::stand);
  rig->stop.state = hal::EmergencyStopState::pressed;
  rig->run(5);
  const auto faults = take(*rig, Event::Kind::fault);
  ASSERT_EQ(faults.size(), 1u) << "told once";
  EXPECT_EQ(faults[0].fault, Fault::emergency_stop);
  EXPECT_NEAR(faults[0].time_s, 1e-3 * static_cast<double>(rig->tick - 5), 1e-9);
}

TEST_F(TorqueCycleTest, TheBlackBoxFreezesAfterAFaultWithWhatWasBefore) {
  rig->mail.black_box.set_aftermath(100);
  rig->stand();
  rig->stop.state = hal::EmergencyStopState::pressed;
  const long long tick_of_fault = rig->tick;
  rig->run(99);
  EXPECT_FALSE(rig->mail.black_box.frozen());
  rig->run(200);
  ASSERT_TRUE(rig->mail.black_box.frozen());
  const auto& box = rig->mail.black_box;
  const auto& last = box.record(box.size() - 1);
  EXPECT_EQ(last.tick, static_cast<std::uint64_t>(tick_of_fault + 100));
  EXPECT_EQ(last.state, State::fault);
  EXPECT_EQ(box.record(box.size() - 1 - 101).state, State::stand);
}

TEST_F(TorqueCycleTest, NoTickAllocates) {
  if (!realtime::counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  rig->stand();
  rig->rungs.reserve(10000);
  const realtime::AllocationScope allocations;
  rig->ask(RequestKind::step);
  rig->run(300);
  rig->joints.silent = true;
  rig->run(50);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace stilt::controller
