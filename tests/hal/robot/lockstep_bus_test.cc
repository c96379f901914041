#include "hal/robot/lockstep_bus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "hal/can/lockstep.h"

namespace stilt::hal {
namespace {

/// A robot that answers each sync with two frames of its own and its sync.
class AnsweringBus final : public FrameBus {
 public:
  bool silent = false;
  bool gone = false;
  std::vector<std::uint64_t> syncs;
  std::vector<CanFrame> waiting;

  SendResult send(std::span<const CanFrame> frames) noexcept override {
    for (const CanFrame& frame : frames) {
      std::uint64_t tick = 0;
      if (decode_sync(kControllerSyncId, frame, tick) != DecodeStatus::ok) continue;
      syncs.push_back(tick);
      if (silent) continue;
      for (const std::uint32_t id : {0x11u, 0x12u}) waiting.push_back(classic_frame(id, 8));
      waiting.push_back(sync_frame(kRobotSyncId, tick));
    }
    return {frames.size(), BusStatus::ok};
  }
  ReceiveResult receive(std::span<CanFrame> frames) noexcept override {
    if (gone) return {0, BusStatus::disconnected};
    const std::size_t count = std::min(frames.size(), waiting.size());
    std::copy_n(waiting.begin(), count, frames.begin());
    waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(count));
    return {count, waiting.empty() ? BusStatus::ok : BusStatus::more};
  }
  BusHealth health() const noexcept override { return BusHealth::active; }
  void clear_bus_off() noexcept override {}
  const BusCounters& counters() const noexcept override { return counters_; }

 private:
  BusCounters counters_;
};

constexpr std::int64_t kTick_ns = 1'000'000;

class LockstepTest : public testing::Test {
 protected:
  LockstepTest() {
    for (std::size_t bus = 0; bus < 2; ++bus) buses[bus].attach(robot[bus]);
  }
  std::array<AnsweringBus, 2> robot;
  std::array<LockstepBus, 2> buses;
};

TEST_F(LockstepTest, TimeIsTheNumberOfTurnsTaken) {
  LockstepClock clock(buses, kTick_ns, 10.0);
  ASSERT_TRUE(clock.open());
  const std::int64_t start_ns = clock.now_ns();
  EXPECT_GT(start_ns, 0) << "0 means never";
  EXPECT_EQ(clock.sleep_until(start_ns + 3 * kTick_ns), start_ns + 3 * kTick_ns);
  EXPECT_EQ(clock.now_ns(), start_ns + 3 * kTick_ns);
  for (const AnsweringBus& bus : robot) EXPECT_EQ(bus.syncs, (std::vector<std::uint64_t>{0, 1, 2, 3}));
}

TEST_F(LockstepTest, FramesOfTheRobotComeThroughAndSyncFramesDoNot) {
  LockstepClock clock(buses, kTick_ns, 10.0);
  ASSERT_TRUE(clock.open());
  std::array<CanFrame, 1> one;
  ASSERT_EQ(buses[0].receive(one).received, 1u);
  EXPECT_EQ(one[0].id, 0x11u);
  const ReceiveResult last = buses[0].receive(one);
  EXPECT_EQ(last.received, 1u);
  EXPECT_EQ(last.status, BusStatus::ok);
  EXPECT_EQ(one[0].id, 0x12u);
  EXPECT_EQ(buses[0].receive(one).received, 0u);
}

TEST_F(LockstepTest, ARobotThatIsSilentOnOneBusIsLost) {
  robot[1].silent = true;
  LockstepClock clock(buses, kTick_ns, 0.01);
  EXPECT_FALSE(clock.open());
  EXPECT_TRUE(clock.lost());
}

TEST_F(LockstepTest, ABusThatGoesAwayEndsTheWaitingAndTimeGoesOnWithoutTheRobot) {
  LockstepClock clock(buses, kTick_ns, 1000.0);
  ASSERT_TRUE(clock.open());
  robot[0].gone = true;
  const std::int64_t before_ns = clock.now_ns();
  EXPECT_EQ(clock.sleep_until(before_ns + 5 * kTick_ns), before_ns + 5 * kTick_ns);
  EXPECT_TRUE(clock.lost());
  EXPECT_EQ(robot[1].syncs, (std::vector<std::uint64_t>{0, 1})) << "and asks no longer";
}

}  // namespace
}  // namespace stilt::hal
