#include "firmware/program/outcome.h"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

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

TEST_F(OutcomeTest, TheJsonHasTheFieldsThatScriptsRead) {
  fault(1.5, Fault::bus_off);
  take_events(*events, outcome);
  outcome.ticks = 7;
  outcome.not_realtime = "kernel 1 is not PREEMPT_RT";
  const auto json = nlohmann::json::parse(to_json(outcome));
  for (const char* field : {"state", "faults", "ticks", "late_ticks", "wakeup_us", "execution_us",
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

}  // namespace
}  // namespace stilt::program
