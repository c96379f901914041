#include "firmware/control_loop/control_loop.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/time.h>

#include <cmath>
#include <limits>

#include "firmware/realtime/allocation_counter.h"
#include "tests/firmware/control_loop/rig.h"

namespace stilt::control_loop {
namespace {

using supervisor::FallbackLevel;
using supervisor::Fault;
using supervisor::RequestKind;
using supervisor::State;

class ControlLoopTest : public testing::RigTest {};

/// Publishes what is in the slots of the plans again and again, in the middle of ticks. It does so by a
/// signal: one processor is enough.
class PublishingSignal {
 public:
  explicit PublishingSignal(Mailboxes& mail) {
    mail_ = &mail;
    struct sigaction action{};
    action.sa_handler = [](int) { mail_->plans.publish(); };
    sigaction(SIGALRM, &action, &before_);
    set_period_us(50);
  }
  ~PublishingSignal() {
    set_period_us(0);
    sigaction(SIGALRM, &before_, nullptr);
  }
  PublishingSignal(const PublishingSignal&) = delete;
  PublishingSignal& operator=(const PublishingSignal&) = delete;

 private:
  static void set_period_us(int period_us) {
    const itimerval period{{0, period_us}, {0, period_us}};
    setitimer(ITIMER_REAL, &period, nullptr);
  }

  static inline Mailboxes* mail_ = nullptr;
  struct sigaction before_{};
};

TEST_F(ControlLoopTest, NothingIsSentBeforeSomebodyAsks) {
  rig->run(200);
  EXPECT_EQ(rig->state(), State::idle);
  EXPECT_EQ(rig->joints.writes, 0);
  EXPECT_EQ(rig->joints.disables, 0);
  EXPECT_EQ(rig->joints.steps, 0);
}

TEST_F(ControlLoopTest, DriversThatCameUpAreDampedAndNoMore) {
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(50);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_EQ(rig->joints.begun, 1);
  EXPECT_GT(rig->joints.writes, 40);
  EXPECT_TRUE(rig->only_damps());
}

TEST_F(ControlLoopTest, ADriverThatCannotBeBroughtUpIsNamedAndEndsInAFault) {
  rig->joints.outcome = {.failed = true,
                         .joint = 3,
                         .stage = hal::bring_up::Stage::failed,
                         .failure = hal::bring_up::Failure::not_home};
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(10);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_EQ(rig->joints.steps, 1) << "the others are not asked any further";
  const auto events = rig->take(Event::Kind::bring_up_failed);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].bring_up.joint, 3);
  EXPECT_EQ(events[0].bring_up.failure, hal::bring_up::Failure::not_home);
}

TEST_F(ControlLoopTest, AfterAFailedBringUpTheNextOneMaySucceed) {
  const hal::BringUpProgress success = rig->joints.outcome;
  rig->joints.outcome = {.failed = true, .stage = hal::bring_up::Stage::failed};
  rig->run(3);
  rig->ask(RequestKind::calibrate);
  rig->run(10);
  ASSERT_EQ(rig->state(), State::fault);
  rig->joints.outcome = success;
  rig->ask(RequestKind::reset);
  rig->run(5);
  rig->ask(RequestKind::calibrate);
  rig->run(5);
  EXPECT_EQ(rig->state(), State::ready);
  EXPECT_EQ(rig->joints.begun, 2);
}

TEST_F(ControlLoopTest, StandingTorquesAreThoseOfTheTorqueLawOnTheNewestPlan) {
  rig->stand();
  const control::Plan& plan = rig->mail.plans.newest();
  control::TorqueLaw law;
  law.configure(*rig->robot, rig->configuration);
  control::SensorReading reading;
  reading.time_s = rig->cycle.time_s();
  reading.joint_position_rad = rig->standing.segment<model::kJoints>(model::kFirstJoint);
  const model::StateVector estimate =
      Eigen::Map<const model::StateVector>(rig->record.estimated_state.data());
  const control::TorqueCommand wanted =
      law.follow(reading, estimate, control::interpolate(plan, reading.time_s));
  ASSERT_TRUE(wanted.finite);
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

TEST_F(ControlLoopTest, ThePitchIsCarriedOnWithItsRateUntilTheNextFrame) {
  constexpr int kPitch = model::kFirstAngle;
  rig->joints.base = {.pitch_rad = 0.1, .pitch_rate_rad_s = 2.0, .time_ns = rig->now_ns()};
  rig->run(1);
  EXPECT_DOUBLE_EQ(rig->record.estimated_state[kPitch], 0.1) << "fresh";
  rig->run(1);
  EXPECT_NEAR(rig->record.estimated_state[kPitch], 0.102, 1e-12);
  rig->run(50);
  EXPECT_NEAR(rig->record.estimated_state[kPitch], 0.12, 1e-12) << "for 10 ms at most";
  rig->joints.base.time_ns = rig->now_ns() + 5'000'000;
  rig->run(1);
  EXPECT_DOUBLE_EQ(rig->record.estimated_state[kPitch], 0.1) << "never back";
}

TEST_F(ControlLoopTest, TheTorqueLawTakesOverGradually) {
  rig->get_ready();
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

TEST_F(ControlLoopTest, AnEncoderThatStandsStillIsAFaultOnceTheTorqueLawIsInCommand) {
  rig->get_ready();
  // Encoders that stick while a joint moved: plans start from that speed.
  for (hal::JointReading& reading : rig->joints.readings) {
    reading.velocity_rad_s = 0.9;
    reading.unchanged_replies = 1000;
  }
  rig->ask(RequestKind::stand);
  rig->run(1000);
  EXPECT_EQ(rig->state(), State::stand) << "still taking over";
  rig->run(1000);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::encoder_frozen));
}

TEST_F(ControlLoopTest, AWalkIsPlannedWithTheSpeedAskedFor) {
  rig->stand();
  rig->ask(RequestKind::walk, 0.3);
  rig->run(2);
  EXPECT_EQ(rig->state(), State::walk);
  const PlanningRequest& request = rig->mail.requests.newest();
  EXPECT_EQ(request.command.kind, gait::GaitKind::walk);
  EXPECT_EQ(request.command.speed_m_s, 0.3);
  EXPECT_EQ(request.stance_episode, 1u);
}

TEST_F(ControlLoopTest, ASensorThatIsNotANumberDampsAtOnceWithFiniteCommands) {
  rig->stand();
  rig->joints.base.pitch_rad = std::numeric_limits<double>::quiet_NaN();
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->only_damps());
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_TRUE(std::isfinite(command.position_rad) && std::isfinite(command.kd_Nms_rad));
  }
}

TEST_F(ControlLoopTest, APlanThatIsNotANumberNeverReachesTheJoints) {
  rig->stand();
  rig->plan_once_more([](control::Plan& bad) {
    for (control::PlanNode& node : bad.node) node.input.setConstant(NAN);
  });
  rig->run(1);
  for (const hal::JointCommand& command : rig->joints.commands) {
    EXPECT_TRUE(std::isfinite(command.torque_Nm));
  }
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::not_finite));
  EXPECT_TRUE(rig->only_damps());
}

TEST_F(ControlLoopTest, APlanIsFollowedToItsEndAndNotBeyond) {
  rig->stand();
  double end_s = 0.0;
  rig->plan_once_more([&](control::Plan& plan) {
    plan.nodes = 4;
    end_s = plan.node[3].time_s;
  });
  rig->run(1);
  ASSERT_LT(rig->cycle.time_s(), end_s);
  for (; rig->cycle.time_s() + 0.0005 < end_s; rig->run(1)) ASSERT_EQ(rig->level(), FallbackLevel::plan);
  rig->run(2);
  EXPECT_EQ(rig->level(), FallbackLevel::sit) << "recent enough, but at its end";
}

TEST_F(ControlLoopTest, OtherGainsAreRecordedFromTheNextTickOnAndTheirTorqueFadesIn) {
  rig->configuration.torque_law.use_feedback_gains = false;  // the plan grows old
  rig->cycle.configure(*rig->robot, rig->configuration, rig->configuration.supervisor);
  rig->stand();
  rig->plan_once_more([](control::Plan&) {});
  rig->joints.readings[1].position_rad += 0.01;
  rig->run(1);
  EXPECT_EQ(rig->record.tuning, 0u);
  const double before_Nm = rig->joints.commands[1].torque_Nm;
  control::TorqueLawParameters stiffer = rig->configuration.torque_law;
  stiffer.joint_kp_Nm_rad += 100.0;
  rig->mail.torque_tunings.writer() = {.number = 3, .law = stiffer};
  rig->mail.torque_tunings.publish();
  rig->run(1);
  EXPECT_EQ(rig->record.tuning, 3u);
  EXPECT_NEAR(rig->joints.commands[1].torque_Nm - before_Nm, 0.0, 0.1);
  const int blend = static_cast<int>(1000 * rig->configuration.supervisor.torque_blend_s);
  for (int tick = 0; tick < blend; ++tick) {
    const double last_Nm = rig->joints.commands[1].torque_Nm;
    rig->run(1);
    EXPECT_NEAR(rig->joints.commands[1].torque_Nm, last_Nm, 0.15) << "no jump";
  }
  control::SensorReading reading;
  reading.time_s = rig->cycle.time_s();
  reading.joint_position_rad = rig->standing.segment<model::kJoints>(model::kFirstJoint);
  reading.joint_position_rad[1] += 0.01;
  const control::PlanPoint point = control::interpolate(rig->mail.plans.newest(), reading.time_s);
  control::TorqueLaw law;
  law.configure(*rig->robot, rig->configuration);
  const double old_Nm = law.follow(reading, point.state, point).torque_Nm[1];
  law.tune(stiffer);
  const double new_Nm = law.follow(reading, point.state, point).torque_Nm[1];
  EXPECT_LT(new_Nm, old_Nm - 0.9) << "100 Nm/rad more at an error of 0.01 rad";
  EXPECT_NEAR(rig->joints.commands[1].torque_Nm, new_Nm, 1e-9);
}

TEST_F(ControlLoopTest, TheEstimateRestsOnTheFeetThatThePlanHasOnTheGround) {
  rig->stand();
  for (const bool left_stands : {true, false}) {
    rig->plan_once_more([&](control::Plan& plan) {
      plan.start_time_s = rig->cycle.time_s();
      for (control::PlanNode& node : plan.node) node.mode = {left_stands, !left_stands};
    });
    rig->run(60);
    const double height_m = rig->record.estimated_state[1];
    const std::size_t swing_knee = left_stands ? 3 : 1;
    const std::size_t stance_knee = left_stands ? 1 : 3;
    const auto bend = [this](std::size_t knee) {
      for (int step = 0; step < 4; ++step) {  // no jump of the encoder
        rig->joints.readings[knee].position_rad += 0.025;
        rig->run(1);
      }
    };
    bend(swing_knee);
    EXPECT_NEAR(rig->record.estimated_state[1], height_m, 1e-12);
    bend(stance_knee);
    EXPECT_LT(rig->record.estimated_state[1], height_m - 0.005);
  }
}

/// Plans that differ in the base's velocity alone, each constant from now on. Were two of them mixed in one
/// tick, their difference would be taken for a change of the velocity.
TEST_F(ControlLoopTest, ATickUsesOnePlanHoweverOftenPlansArePublishedMeanwhile) {
  constexpr double kAhead_s = 30.0;
  rig->stand();
  for (int slot = 0; slot < 3; ++slot) {
    rig->plan_once_more([slot](control::Plan& plan) {
      if (slot == 0) plan.start_time_s += kAhead_s;
      for (control::PlanNode& node : plan.node) {
        if (slot == 0) node.time_s += kAhead_s;
        node.state[model::kPositions] += 1.0;
      }
    });
  }
  double velocity_max_m_s = 0.0;
  {
    const PublishingSignal signal(rig->mail);
    for (int tick = 0; tick < 20000; ++tick) {
      rig->run(1);
      velocity_max_m_s = std::max(velocity_max_m_s, std::abs(rig->record.estimated_state[model::kPositions]));
    }
  }
  EXPECT_EQ(rig->level(), FallbackLevel::plan);
  EXPECT_LT(velocity_max_m_s, 0.01) << "the robot stands still";
}

TEST_F(ControlLoopTest, ACommandThatTheBusRefusesIsAFault) {
  rig->stand();
  rig->joints.write_status = hal::JointBusStatus::refused;
  rig->run(2);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::not_finite));
}

TEST_F(ControlLoopTest, ALostHeartbeatEndsAWalk) {
  rig->stand();
  rig->ask(RequestKind::walk, 0.3);
  rig->command.heartbeat_expected = true;
  rig->command.heartbeat_ns = rig->now_ns();
  const int timeout = static_cast<int>(1000 * rig->configuration.supervisor.heartbeat_timeout_s);
  rig->run(timeout - 2);
  EXPECT_EQ(rig->state(), State::walk);
  rig->run(4);
  EXPECT_EQ(rig->state(), State::step);
  EXPECT_TRUE(rig->decision().present.has(Fault::heartbeat_lost));
}

TEST_F(ControlLoopTest, AfterALatchedFaultNothingButDampingIsSentWhateverIsAsked) {
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->only_damps()) << "in the very tick";
  rig->joints.emergency_stop = hal::EmergencyStopState::released;
  for (const RequestKind kind :
       {RequestKind::stand, RequestKind::walk, RequestKind::calibrate, RequestKind::sit}) {
    rig->ask(kind);
    rig->run(20);
    EXPECT_EQ(rig->state(), State::fault);
    EXPECT_TRUE(rig->only_damps());
  }
  rig->ask(RequestKind::reset);
  rig->run(20);
  EXPECT_EQ(rig->state(), State::fault) << "the joints are damped first";
  rig->run(rig->damped_ticks());
  EXPECT_EQ(rig->state(), State::idle);
  EXPECT_GE(rig->joints.restored, 1);
}

TEST_F(ControlLoopTest, BusErrorsAreNoticedInTheTickTheyAreCounted) {
  rig->stand();
  rig->run(5);
  EXPECT_FALSE(rig->decision().present.has(Fault::bus_error));
  rig->joints.error_count += 3;
  rig->run(1);
  EXPECT_TRUE(rig->decision().present.has(Fault::bus_error));
  rig->run(1);
  EXPECT_FALSE(rig->decision().present.has(Fault::bus_error));
  for (std::uint32_t* malformed : {&rig->joints.readings[2].malformed, &rig->joints.base.malformed}) {
    ++*malformed;
    rig->run(1);
    EXPECT_TRUE(rig->decision().present.has(Fault::bus_error));
    rig->run(1);
    EXPECT_FALSE(rig->decision().present.has(Fault::bus_error));
  }
}

TEST_F(ControlLoopTest, ALongTickIsAFault) {
  rig->stand();
  rig->wakeup_latency_ns = 20'000'000;
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::torque_loop_stalled));
}

TEST_F(ControlLoopTest, AStallInsideATickIsAFault) {
  rig->stand();
  rig->tick += 20;  // the loop wakes in time for a later period
  rig->run(1);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_TRUE(rig->decision().latched.has(Fault::torque_loop_stalled));
}

TEST_F(ControlLoopTest, NoTickAllocates) {
  if (!realtime::counts_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  rig->stand();
  rig->levels.reserve(10000);
  const realtime::AllocationScope allocations;
  rig->ask(RequestKind::step);
  rig->run(300);
  rig->joints.silent = true;
  rig->run(50);
  EXPECT_EQ(rig->state(), State::fault);
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace stilt::control_loop
