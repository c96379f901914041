#include "hal/robot/lockstep_bus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "hal/can/lockstep.h"

namespace stilt::hardware {
namespace {

/// A robot that answers each sync with two frames of its own and its sync.
class AnsweringBus final : public hal::FrameBus {
 public:
  bool silent = false;
  bool gone = false;
  std::vector<std::uint64_t> syncs;
  std::vector<hal::CanFrame> waiting;

  hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    for (const hal::CanFrame& frame : frames) {
      std::uint64_t tick = 0;
      if (hal::protocol::decode_sync(hal::protocol::kControllerSyncId, frame, tick) !=
          hal::protocol::DecodeStatus::ok)
        continue;
      syncs.push_back(tick);
      if (silent) continue;
      for (const std::uint32_t id : {0x11u, 0x12u}) waiting.push_back(hal::classic_frame(id, 8));
      waiting.push_back(hal::protocol::sync_frame(hal::protocol::kRobotSyncId, tick));
    }
    return {frames.size(), hal::BusStatus::ok};
  }
  hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    if (gone) return {0, hal::BusStatus::disconnected};
    const std::size_t count = std::min(frames.size(), waiting.size());
    std::copy_n(waiting.begin(), count, frames.begin());
    waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(count));
    return {count, waiting.empty() ? hal::BusStatus::ok : hal::BusStatus::more};
  }
  hal::BusHealth health() const noexcept override { return hal::BusHealth::active; }
  void clear_bus_off() noexcept override {}
  const hal::BusCounters& counters() const noexcept override { return counters_; }

 private:
  hal::BusCounters counters_;
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
  std::array<hal::CanFrame, 1> one;
  ASSERT_EQ(buses[0].receive(one).received, 1u);
  EXPECT_EQ(one[0].id, 0x11u);
  const hal::ReceiveResult last = buses[0].receive(one);
  EXPECT_EQ(last.received, 1u);
  EXPECT_EQ(last.status, hal::BusStatus::ok);
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
  EXPECT_EQ(robot[1].syncs, (std::vector<std::uint64_t>{0, 1})) << "and asks nobody any more";
}

}  // namespace
}  // namespace stilt::hardware
