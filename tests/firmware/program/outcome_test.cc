#include "firmware/program/outcome.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/firmware/supervisor/printers.h"

namespace stilt::program {
namespace {

using control_loop::Event;
using supervisor::Fault;
using supervisor::State;

class OutcomeTest : public testing::Test {
 protected:
  OutcomeTest() : events(std::make_unique<control_loop::EventRing>()) {}
  void state(double time_s, State state) {
    events->push({.kind = Event::Kind::state, .time_s = time_s, .state = state});
  }
  void fault(double time_s, Fault fault) {
    events->push({.kind = Event::Kind::fault, .time_s = time_s, .fault = fault});
  }
  std::unique_ptr<control_loop::EventRing> events;
  Outcome outcome;
};

TEST_F(OutcomeTest, TheStateBeforeOffIsKept) {
  state(0.0, State::idle);
  state(1.0, State::fault);
  state(2.0, State::off);
  take_events(*events, outcome);
  EXPECT_EQ(outcome.state, "off");
  EXPECT_EQ(outcome.last_state, "fault");
}

TEST_F(OutcomeTest, WhatTheRingLostIsCountedAndTheEndIsThatOfTheTorqueLoop) {
  state(0.0, State::stand);
  fault(1.0, Fault::emergency_stop);
  state(1.0, State::fault);
  state(8.0, State::off);
  take_events(*events, outcome);
  supervisor::FaultSet latched;
  latched.add(Fault::emergency_stop);
  latched.add(Fault::driver_fault);
  testing::internal::CaptureStderr();
  take_end({.time_s = 9.0, .state = State::off, .last_state = State::fault, .latched = latched}, 7, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("9.000 s  7 events were lost"), std::string::npos) << said;
  EXPECT_NE(said.find("fault driver_fault: a driver reports a fault; reaction: damp"), std::string::npos)
      << said;
  EXPECT_EQ(said.find("emergency_stop"), std::string::npos) << "it was reported" << said;
  const auto json = nlohmann::json::parse(to_json(outcome));
  EXPECT_EQ(json["state"], "off");
  EXPECT_EQ(json["last_state"], "fault");
  EXPECT_EQ(json["dropped_events"], 7);
  ASSERT_EQ(json["faults"].size(), 2u);
  EXPECT_EQ(json["faults"][1]["name"], "driver_fault");
  EXPECT_TRUE(json["faults"][1]["time_s"].is_null()) << "its event was lost";
}

TEST_F(OutcomeTest, AFaultThatFlickersIsOneEntryUntilAReset) {
  state(0.0, State::walk);
  fault(1.0, Fault::driver_fault);
  state(1.0, State::fault);
  fault(1.1, Fault::driver_fault);
  fault(1.2, Fault::emergency_stop);
  state(2.0, State::idle);
  fault(3.0, Fault::driver_fault);
  take_events(*events, outcome);
  ASSERT_EQ(outcome.faults.size(), 3u);
  EXPECT_EQ(outcome.faults[0].name, "driver_fault");
  EXPECT_EQ(outcome.faults[0].time_s, 1.0);
  EXPECT_EQ(outcome.faults[0].count, 2);
  EXPECT_EQ(outcome.faults[0].reaction, "damp");
  EXPECT_EQ(outcome.faults[1].name, "emergency_stop");
  EXPECT_EQ(outcome.faults[2].time_s, 3.0);
}

TEST_F(OutcomeTest, APoseIsSaidWithItsJointItsAngleAndItsRange) {
  const control_loop::PoseMiss knee{1, 1.25, 0.5, 0.9};
  const control_loop::PoseMiss torso{control_loop::PoseMiss::kTorso, -0.5, -0.2, 0.2};
  const control_loop::PoseMiss fast{2, NAN, -0.1, 0.1, "rad/s"};
  events->push({.kind = Event::Kind::waits_for_pose, .time_s = 1.0, .pose = knee});
  events->push({.kind = Event::Kind::lost_stance, .time_s = 2.0, .pose = torso});
  events->push({.kind = Event::Kind::stopped_waiting, .time_s = 3.0, .pose = fast});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(
      said.find("not in a pose to stand up from: knee_L is at 1.25 rad, must be within 0.5 rad and 0.9 rad; "
                "waits until somebody puts it there"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find("the torso is at -0.5 rad, must be within -0.2 rad and 0.2 rad; damped"),
            std::string::npos)
      << said;
  EXPECT_NE(
      said.find("hip_R is at not a number, must be within -0.1 rad/s and 0.1 rad/s; put it there and ask"),
      std::string::npos)
      << said;
}

TEST_F(OutcomeTest, TheEndOfAFaultOrWarningIsSaidOnceAndInTheReport) {
  const auto over = [this](double time_s, Fault fault) {
    events->push({.kind = Event::Kind::fault_over, .time_s = time_s, .fault = fault});
  };
  fault(1.0, Fault::emergency_stop);
  fault(1.0, Fault::bus_error);
  over(1.1, Fault::bus_error);
  fault(1.2, Fault::bus_error);
  over(1.3, Fault::bus_error);
  over(2.0, Fault::emergency_stop);
  fault(2.5, Fault::emergency_stop);
  over(3.0, Fault::emergency_stop);
  fault(4.0, Fault::missed_replies);
  over(4.1, Fault::missed_replies);
  fault(5.0, Fault::missed_replies);
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("2.000 s  fault emergency_stop: over, and waits for a reset\n"), std::string::npos)
      << said;
  EXPECT_EQ(said.find("3.000 s"), std::string::npos) << "once" << said;
  EXPECT_NE(said.find("4.100 s  fault missed_replies: over\n"), std::string::npos) << said;
  EXPECT_NE(said.find("1.100 s  fault bus_error: over\n"), std::string::npos) << said;
  EXPECT_EQ(said.find("1.300 s"), std::string::npos) << "once" << said;
  const auto json = nlohmann::json::parse(to_json(outcome));
  EXPECT_EQ(json["faults"][0]["over_s"], 3.0);
  EXPECT_EQ(json["faults"][1]["over_s"], 1.3);
  EXPECT_FALSE(json["faults"][2].contains("over_s")) << "it came again";
}

TEST_F(OutcomeTest, TheJsonHasTheFieldsThatScriptsRead) {
  fault(1.5, Fault::bus_off);
  take_events(*events, outcome);
  outcome.ticks = 7;
  outcome.not_realtime = "kernel 1 is not PREEMPT_RT";
  const auto json = nlohmann::json::parse(to_json(outcome));
  for (const char* field :
       {"state", "faults", "dropped_events", "ticks", "late_ticks", "wakeup_us", "execution_us",
        "bus_round_trip_us", "solve_us", "heap_allocations", "page_faults", "realtime"}) {
    EXPECT_TRUE(json.contains(field)) << field;
  }
  EXPECT_EQ(json["faults"][0]["name"], "bus_off");
  EXPECT_EQ(json["faults"][0]["time_s"], 1.5);
  EXPECT_EQ(json["faults"][0]["reaction"], "damp");
  for (const char* field : {"p50", "p99", "max"}) EXPECT_TRUE(json["wakeup_us"].contains(field));
  EXPECT_EQ(json["realtime"], "kernel 1 is not PREEMPT_RT");
  outcome.not_realtime.clear();
  EXPECT_EQ(nlohmann::json::parse(to_json(outcome))["realtime"], true);
}

TEST_F(OutcomeTest, TheResultsNameStartCommitAndRun) {
  outcome.started = utc_now();
  outcome.commit = "0123456789ab";
  EXPECT_FALSE(nlohmann::json::parse(to_json(outcome)).contains("run_id")) << "without telemetry";
  outcome.run_id = 9007199254740991;
  const auto json = nlohmann::json::parse(to_json(outcome));
  EXPECT_TRUE(
      std::regex_match(json["started"].get<std::string>(), std::regex(R"(20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ)")))
      << json["started"];
  EXPECT_EQ(json["commit"], "0123456789ab");
  EXPECT_EQ(json["run_id"], 9007199254740991);
}

TEST_F(OutcomeTest, AFaultNamesItsJointTheVendorCodeAndTheNumbers) {
  events->push({.kind = Event::Kind::fault,
                .time_s = 1.0,
                .fault = Fault::driver_fault,
                .found = {.joint = 1, .driver_fault = hal::DriverFault::encoder, .fault_code = 35}});
  events->push({.kind = Event::Kind::fault,
                .time_s = 2.0,
                .fault = Fault::driver_hot,
                .found = {.joint = 2, .value = 77, .limit = 75, .unit = "C"}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("a driver reports a fault: knee_L, encoder, vendor code 35; reaction: damp"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find(": hip_R, 77 C, limit 75 C; reaction: warn"), std::string::npos) << said;
  const auto json = nlohmann::json::parse(to_json(outcome));
  EXPECT_EQ(json["faults"][0]["joint"], "knee_L");
  EXPECT_EQ(json["faults"][0]["driver_fault"], "encoder");
  EXPECT_EQ(json["faults"][0]["fault_code"], 35);
  EXPECT_FALSE(json["faults"][0].contains("limit"));
  EXPECT_EQ(json["faults"][1]["joint"], "hip_R");
  EXPECT_EQ(json["faults"][1]["value"], 77);
  EXPECT_EQ(json["faults"][1]["limit"], 75);
  EXPECT_EQ(json["faults"][1]["unit"], "C");
}

TEST_F(OutcomeTest, AFaultNamesItsBusAndItsCondition) {
  events->push({.kind = Event::Kind::fault, .fault = Fault::bus_off, .found = {.bus = 1}});
  events->push(
      {.kind = Event::Kind::fault, .fault = Fault::emergency_stop, .found = {.condition = "silent"}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("took itself off: bus 1 of hardware.buses; reaction: damp"), std::string::npos) << said;
  EXPECT_NE(said.find("is pressed, or silent: silent; reaction: damp"), std::string::npos) << said;
  const auto json = nlohmann::json::parse(to_json(outcome));
  EXPECT_EQ(json["faults"][0]["bus"], 1);
  EXPECT_FALSE(json["faults"][0].contains("condition"));
  EXPECT_EQ(json["faults"][1]["condition"], "silent");
  EXPECT_FALSE(json["faults"][1].contains("bus"));
}

TEST_F(OutcomeTest, ADriverThatCannotBeBroughtUpNamesItsFaultAndSetting) {
  events->push({.kind = Event::Kind::bring_up_failed,
                .time_s = 1.0,
                .bring_up = {.joint = 3,
                             .failure = hal::bring_up::Failure::driver_fault,
                             .fault = hal::DriverFault::position_limit,
                             .fault_code = 39,
                             .setting = hal::bring_up::Setting::moteus_position_bounds}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("driver of knee_R cannot be brought up: driver fault (position limit, vendor code 39); "
                      "servopos.position_min"),
            std::string::npos)
      << said;
}

TEST_F(OutcomeTest, ADriverOfAnotherVersionIsNamedWithBothAndTheKey) {
  events->push({.kind = Event::Kind::bring_up_failed,
                .time_s = 1.0,
                .bring_up = {.joint = 1,
                             .failure = hal::bring_up::Failure::wrong_version,
                             .setting = hal::bring_up::Setting::odrive_firmware_version,
                             .version = 0x00060c,
                             .wanted_version = 0x00060b}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(
      said.find("driver of knee_L cannot be brought up: version differs from the configuration: 0.6.12 "
                "instead of 0.6.11; in knee_driver, odrive_firmware_version must be that of the driver, "
                "and all endpoints those of its flat_endpoints.json"),
      std::string::npos)
      << said;
}

TEST_F(OutcomeTest, ADriverWhoseRepliesAreLateIsNamedWithTheirLag) {
  events->push(
      {.kind = Event::Kind::bring_up_failed,
       .time_s = 1.0,
       .bring_up = {.joint = 1, .failure = hal::bring_up::Failure::slow_reply, .reply_lag_s = 0.0155}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("driver of knee_L cannot be brought up: replies come too late: after 15.5 ms, see "
                      "hardware.longest_reply_lag_s"),
            std::string::npos)
      << said;
}

TEST_F(OutcomeTest, ADriverWhoseOffsetMayBeVoidIsNamedWithWhatToDo) {
  events->push({.kind = Event::Kind::bring_up_failed,
                .time_s = 1.0,
                .bring_up = {.joint = 1, .failure = hal::bring_up::Failure::void_offsets}});
  testing::internal::CaptureStderr();
  take_events(*events, outcome);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(
      said.find("driver of knee_L cannot be brought up: its offset is void: it was silent or has started "
                "again, so its power or its cable was lost"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find("`stiltd selftest --hanging`"), std::string::npos) << said;
}

}  // namespace
}  // namespace stilt::program
