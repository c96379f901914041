#include <gtest/gtest.h>

#include <vector>

#include "hal/bring_up/bring_up.h"
#include "hal/moteus/moteus_driver.h"
#include "hal/moteus/moteus_emulator.h"
#include "tests/hal/can/fdcanusb/adapter_rig.h"

namespace stilt::hal::fdcanusb {
namespace {

using bring_up::Stage;
using bring_up::StepResult;

constexpr std::int64_t kTick_ns = 1'000'000;

/// Emulated moteus drivers on the bus of an emulated adapter, in virtual time: each tick ends when all that
/// it caused has arrived.
class MoteusBehindAdapter : public AdapterRig {
 protected:
  void attach(moteus::MoteusEmulator& driver) { drivers_.push_back(&driver); }

  /// What the drivers send goes to the adapter.
  void serve_drivers(FdcanusbBus& bus, std::uint64_t frames) {
    ASSERT_TRUE(until([&] { return emulator.on_bus().size() >= frames; }));
    FrameSink replies;
    for (; taken_ < frames; ++taken_) {
      for (EmulatedDriver* driver : drivers_) driver->take(now_ns_, emulator.on_bus()[taken_], replies);
    }
    for (EmulatedDriver* driver : drivers_) driver->elapse(now_ns_, replies);
    for (const CanFrame& reply : replies.frames()) emulator.deliver(reply);
    received_.clear();
    ASSERT_TRUE(until([&] {
      const auto some = receive_all(bus.frames());
      received_.insert(received_.end(), some.begin(), some.end());
      return received_.size() == replies.frames().size();
    }));
    ASSERT_TRUE(until([&] { return counters(bus.frames()).confirmed == frames; }));
  }

  /// One tick of several bring-ups.
  void tick(FdcanusbBus& bus, std::vector<bring_up::BringUp*> all, std::vector<StepResult>& results) {
    std::vector<CanFrame> frames;
    for (std::size_t i = 0; i < all.size(); ++i) {
      results[i] = all[i]->step(now_ns_, received_);
      if (results[i].send) frames.push_back(results[i].frame);
    }
    ASSERT_EQ(bus.frames().send(frames).sent, frames.size());
    sent_ += frames.size();
    serve_drivers(bus, sent_);
    now_ns_ += kTick_ns;
  }

  std::int64_t now_ns_ = 0;

 private:
  std::vector<EmulatedDriver*> drivers_;
  std::vector<CanFrame> received_;
  std::uint64_t sent_ = 0;
  std::uint64_t taken_ = 0;
};

TEST_F(MoteusBehindAdapter, TwoDriversComeUpWithTheirWatchdogs) {
  const moteus::MoteusDriver left{.id = 1};
  const moteus::MoteusDriver right{.id = 2};
  moteus::MoteusEmulator left_driver = moteus::make_emulator(left);
  moteus::MoteusEmulator right_driver = moteus::make_emulator(right);
  left_driver.motor.position_rad = 1.25;
  right_driver.motor.position_rad = -0.5;
  attach(left_driver);
  attach(right_driver);
  FdcanusbBus bus;
  ASSERT_EQ(open(bus), "");
  moteus::MoteusBringUp left_up = make_bring_up(left, {});
  moteus::MoteusBringUp right_up = make_bring_up(right, {});
  std::vector<StepResult> results(2);
  constexpr int kMostTicks = 1000;
  for (int i = 0; i < kMostTicks && (results[0].stage < Stage::ready || results[1].stage < Stage::ready);
       ++i) {
    tick(bus, {&left_up, &right_up}, results);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(results[0].stage, Stage::ready) << name(results[0].failure);
  EXPECT_EQ(results[1].stage, Stage::ready) << name(results[1].failure);
  EXPECT_TRUE(left_driver.enabled());
  EXPECT_TRUE(right_driver.enabled());
  EXPECT_NEAR(results[0].position_rad, 1.25, 1e-4);
  EXPECT_NEAR(results[1].position_rad, -0.5, 1e-4);
  EXPECT_EQ(counters(bus.frames()).malformed, 0u);
  EXPECT_EQ(counters(bus.frames()).withheld, 0u);
}

}  // namespace
}  // namespace stilt::hal::fdcanusb
