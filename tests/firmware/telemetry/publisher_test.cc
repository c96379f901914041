// Messages of stilt_msgs.idl, off the wire: each number in its field.
#include "firmware/telemetry/publisher.h"

#include <gtest/gtest.h>

#include "firmware/configuration/configuration.h"
#include "tests/firmware/telemetry/numbered_statistics.h"
#include "tests/firmware/telemetry/one_sample.h"
#include "tests/own_domain.h"

namespace stilt::telemetry {
namespace {

using control_loop::PoseMiss;
using Kind = control_loop::Event::Kind;
using testing::one_sample;

class PublisherTest : public ::testing::Test {
 protected:
  void SetUp() override {
    participant = Participant::open({.domain = tests::own_domain()});
    ASSERT_TRUE(participant.has_value()) << participant.error();
    auto opened = Publisher::open(*participant, 77);
    ASSERT_TRUE(opened.has_value()) << opened.error();
    publisher = std::move(*opened);
  }

  std::expected<Participant, std::string> participant;
  Publisher publisher;
};

TEST_F(PublisherTest, TimingHasEachNumberInItsField) {
  const diagnostics::LoopStatistics loop = testing::numbered_loop_statistics();
  const diagnostics::PlannerStatistics planning = testing::numbered_planner_statistics();
  const Sample sample = one_sample(*participant, kTiming, [&] {
    publisher.timing(loop, planning, {}, 1.5, {.ticks = 17, .cycles = 19, .events = 23});
  });
  const auto message = sample.as<Timing>();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->run_id, 77u);
  EXPECT_EQ(message->time_s, 1.5);
  EXPECT_EQ(message->ticks, 101u);
  EXPECT_EQ(message->late_ticks, 7u);
  EXPECT_EQ(message->missed_periods, 11u);
  EXPECT_EQ(message->plans, 13u);
  EXPECT_EQ(message->heap_allocations, 32u);
  EXPECT_EQ(message->page_faults, 53u);
  EXPECT_EQ(message->dropped_ticks, 17u);
  EXPECT_EQ(message->dropped_cycles, 19u);
  EXPECT_EQ(message->dropped_events, 23u);
  ASSERT_EQ(message->histograms._length, 4u);
  const char* const names[] = {"wakeup_latency", "execution", "bus_round_trip", "solve"};
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_STREQ(message->histograms._buffer[i].name, names[i]);
    EXPECT_EQ(message->histograms._buffer[i].max_us, 1000 * (i + 1));
  }
}

TEST_F(PublisherTest, AFlushEndsOnceSubscribersHaveWhatWasSent) {
  EXPECT_TRUE(publisher.flush(1.0)) << "without subscribers";
  static_cast<void>(one_sample(*participant, kEvents, [&] {
    publisher.event({.kind = Kind::lost_stance, .time_s = 2.5}, {});
    EXPECT_TRUE(publisher.flush(60.0));
  }));
}

TEST_F(PublisherTest, AnEventOfAPoseAboveItsRangeHasTheUpperLimit) {
  const PoseMiss knee{.joint = 1, .value = 1.25, .lowest = 0.5, .highest = 0.9};
  const Sample sample = one_sample(*participant, kEvents, [&] {
    publisher.event({.kind = Kind::lost_stance, .time_s = 2.5, .pose = knee}, {});
  });
  const auto above = sample.as<Event>();
  ASSERT_TRUE(above);
  EXPECT_EQ(above->time_s, 2.5);
  EXPECT_EQ(above->kind, 6);
  EXPECT_EQ(above->joint, 1);
  EXPECT_EQ(above->value, 1.25);
  EXPECT_EQ(above->limit, 0.9);
}

TEST_F(PublisherTest, AnEventOfAPoseBelowItsRangeHasTheLowerLimit) {
  const PoseMiss torso{.joint = PoseMiss::kTorso, .value = -0.4, .lowest = -0.3, .highest = 0.2};
  const Sample sample = one_sample(*participant, kEvents, [&] {
    publisher.event({.kind = Kind::waits_for_pose, .time_s = 2.5, .pose = torso}, {});
  });
  const auto below = sample.as<Event>();
  ASSERT_TRUE(below);
  EXPECT_EQ(below->kind, 2);
  EXPECT_EQ(below->joint, -1) << "the torso is no joint";
  EXPECT_EQ(below->value, -0.4);
  EXPECT_EQ(below->limit, -0.3);
}

}  // namespace
}  // namespace stilt::telemetry
