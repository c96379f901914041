// Events, black box and records of ticks.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/control_loop/control_loop.h"
#include "tests/firmware/control_loop/rig.h"
#include "tests/firmware/supervisor/printers.h"

namespace stilt::control_loop {
namespace {

using supervisor::FallbackLevel;
using supervisor::Fault;
using supervisor::State;

class ControlLoopReports : public testing::RigTest {
 protected:
  /// A standing robot holds its pose for a few ticks without replies, and stands again.
  void freeze_the_black_box_by_silent_drivers() {
    rig->mail.black_box.set_aftermath(20);
    rig->stand();
    rig->joints.silent = true;
    rig->run(5);
    rig->joints.silent = false;
    rig->run(50);
  }
};

TEST_F(ControlLoopReports, FaultsAndStatesAreReported) {
  rig->stand();
  const auto states = rig->take(Event::Kind::state);
  ASSERT_GE(states.size(), 4u);
  EXPECT_EQ(states.back().state, State::stand);
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(5);
  const auto faults = rig->take(Event::Kind::fault);
  ASSERT_EQ(faults.size(), 1u) << "reported once";
  EXPECT_EQ(faults[0].fault, Fault::emergency_stop);
  EXPECT_NEAR(faults[0].time_s, 1e-3 * static_cast<double>(rig->tick - 5), 1e-9);
}

TEST_F(ControlLoopReports, TheEndOfAFaultIsAnEvent) {
  rig->stand();
  static_cast<void>(rig->take(Event::Kind::fault_over));
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(5);
  EXPECT_TRUE(rig->take(Event::Kind::fault_over).empty());
  rig->joints.emergency_stop = hal::EmergencyStopState::released;
  rig->run(5);
  const auto over = rig->take(Event::Kind::fault_over);
  ASSERT_EQ(over.size(), 1u);
  EXPECT_EQ(over[0].fault, Fault::emergency_stop);
}

TEST_F(ControlLoopReports, AFaultThatIsNotLookedForAnyMoreIsNotOver) {
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->joints.base.pitch_rad = 1.0;
  rig->run(1);
  ASSERT_EQ(rig->state(), State::fault);
  ASSERT_TRUE(rig->decision().latched.has(Fault::base_pitch_limit));
  static_cast<void>(rig->take(Event::Kind::fault_over));
  rig->run(5);
  EXPECT_FALSE(rig->decision().present.has(Fault::base_pitch_limit)) << "of standing and sitting alone";
  EXPECT_TRUE(rig->take(Event::Kind::fault_over).empty());
}

TEST_F(ControlLoopReports, TheEndOfARunEndsNoFaultThatIsNotLookedForThen) {
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->joints.read_status = hal::JointBusStatus::disconnected;
  rig->run(5);
  static_cast<void>(rig->take(Event::Kind::fault_over));
  rig->mail.stops.cut = true;
  rig->run(5);
  ASSERT_EQ(rig->state(), State::off);
  EXPECT_TRUE(rig->take(Event::Kind::fault_over).empty()) << "stop and bus are as they were";
}

TEST_F(ControlLoopReports, AFlickeringWarningDisplacesNoStateInAFullRing) {
  rig->stand();
  for (int i = 0; i < 200; ++i) {
    ++rig->joints.error_count;
    rig->run(2);
  }
  EXPECT_GT(rig->mail.events.dropped(), 0u);
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(5);
  EXPECT_EQ(rig->cycle.last_state(), State::fault);
  std::vector<State> states;
  std::vector<Fault> faults;
  while (const Event* event = rig->mail.events.front()) {
    if (event->kind == Event::Kind::state) states.push_back(event->state);
    if (event->kind == Event::Kind::fault) faults.push_back(event->fault);
    rig->mail.events.pop();
  }
  EXPECT_EQ(states.back(), State::fault);
  EXPECT_EQ(faults.back(), Fault::emergency_stop);
}

TEST_F(ControlLoopReports, TheLastStateIsTheOneBeforeOff) {
  rig->stand();
  rig->mail.stops.cut = true;
  rig->run(3);
  ASSERT_EQ(rig->state(), State::off);
  EXPECT_EQ(rig->cycle.last_state(), State::stand);
}

TEST_F(ControlLoopReports, TheBlackBoxFreezesAfterAFaultWithWhatWasBefore) {
  rig->mail.black_box.set_aftermath(100);
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
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

TEST_F(ControlLoopReports, TheBlackBoxFreezesWhenThePoseIsHeldAndNotForAWarning) {
  rig->mail.black_box.set_aftermath(20);
  rig->stand();
  ++rig->joints.error_count;
  rig->run(50);
  EXPECT_FALSE(rig->mail.black_box.frozen()) << "a warning";
  rig->joints.silent = true;
  rig->run(5);
  ASSERT_EQ(rig->level(), FallbackLevel::hold);
  rig->joints.silent = false;
  rig->run(50);
  EXPECT_EQ(rig->state(), State::stand);
  EXPECT_TRUE(rig->mail.black_box.frozen());
}

TEST_F(ControlLoopReports, TheBlackBoxIsThereForTheFallAfterAGlitchAndForOneOfAFall) {
  freeze_the_black_box_by_silent_drivers();
  ASSERT_TRUE(rig->mail.black_box.frozen());
  rig->mail.black_box.rearm();
  rig->run(50);
  EXPECT_FALSE(rig->mail.black_box.frozen());
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(50);
  ASSERT_TRUE(rig->mail.black_box.frozen()) << "the fall";
  rig->mail.black_box.rearm();
  rig->run(500);
  EXPECT_FALSE(rig->mail.black_box.frozen()) << "the fall is in one record only";
}

TEST_F(ControlLoopReports, AFallWhileTheBlackBoxIsFrozenTriggersItWhenItIsArmedAgain) {
  freeze_the_black_box_by_silent_drivers();
  ASSERT_TRUE(rig->mail.black_box.frozen());
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(50);
  rig->mail.black_box.rearm();
  rig->run(50);
  ASSERT_TRUE(rig->mail.black_box.frozen());
  const auto& box = rig->mail.black_box;
  EXPECT_EQ(box.record(box.trigger()).state, State::fault);
  EXPECT_EQ(box.record(box.trigger() - 1).state, State::stand) << "from before it was frozen";
}

TEST_F(ControlLoopReports, ARecordHoldsTheTimesOfItsTickAndWhatLeft) {
  rig->stand();
  rig->cycle.tick(
      {.now_ns = rig->now_ns(), .wakeup_latency_ns = 1000, .execution_ns = 2000, .bus_round_trip_ns = 3000});
  const control_loop::TickRecord& record = *rig->mail.telemetry.front();
  EXPECT_EQ(record.tick, static_cast<std::uint64_t>(rig->tick));
  EXPECT_EQ(record.time_ns, rig->now_ns());
  EXPECT_EQ(record.wakeup_latency_ns, 1000);
  EXPECT_EQ(record.execution_ns, 2000);
  EXPECT_EQ(record.bus_round_trip_ns, 3000);
  EXPECT_EQ(record.action, supervisor::Action::commands);
  EXPECT_EQ(record.sent[1].torque_Nm, rig->joints.commands[1].torque_Nm);
  EXPECT_EQ(record.plan_sequence, rig->mail.plans.newest().sequence);
  const control::Plan& plan = rig->mail.plans.newest();
  EXPECT_NEAR(record.plan_age_s, rig->cycle.time_s() - plan.start_time_s, 1e-12);
  const control::PlanPoint planned = control::interpolate(plan, rig->cycle.time_s());
  for (int j = 0; j < model::kJoints; ++j) {
    const hal::JointCommand& wanted = record.wanted[static_cast<std::size_t>(j)];
    EXPECT_EQ(wanted.position_rad, planned.state[model::kFirstJoint + j]);
    EXPECT_EQ(wanted.velocity_rad_s, planned.state[model::kPositions + model::kFirstJoint + j]);
  }
}

TEST_F(ControlLoopReports, AfterAFaultNoPlanHasAnAgeAndNothingLeadsTheJoints) {
  rig->stand();
  rig->joints.emergency_stop = hal::EmergencyStopState::pressed;
  rig->run(1);
  ASSERT_EQ(rig->record.state, State::fault);
  EXPECT_TRUE(std::isnan(rig->record.plan_age_s));
  EXPECT_EQ(rig->record.plan_sequence, -1);
  EXPECT_TRUE(std::isnan(rig->record.wanted[0].position_rad));
}

}  // namespace
}  // namespace stilt::control_loop
