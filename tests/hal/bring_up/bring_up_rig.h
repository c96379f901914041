#pragma once

#include <gtest/gtest.h>

#include <array>
#include <span>

#include "hal/mit/mit_bring_up.h"
#include "hal/mit/mit_emulator.h"
#include "hal/moteus/moteus_bring_up.h"
#include "hal/moteus/moteus_emulator.h"
#include "hal/odrive/odrive_bring_up.h"
#include "hal/odrive/odrive_emulator.h"
#include "tests/hal/mock/mock_bus.h"

namespace stilt::hal::bring_up {

using mit::MitBringUp;
using mit::MitEmulator;
using moteus::MoteusBringUp;
using moteus::MoteusEmulator;
using odrive::OdriveBringUp;
using odrive::OdriveEmulator;

inline constexpr std::int64_t kTick_ns = 1'000'000;
inline constexpr odrive::OdriveEndpoints kEndpoints{.watchdog_timeout = 0x191,
                                                    .enable_watchdog = 0x192,
                                                    .firmware_version = 0x00060b,   // 0.6.11
                                                    .hardware_version = 0x04043a};  // 4.4.58

/// Ticks until the bring-up has ended one way or the other; a bound instead of a hang.
inline StepResult run(BringUp& bring_up, mock::MockBus& bus, mock::MockClock& clock, int ticks = 2000) {
  StepResult result;
  for (int tick = 0; tick < ticks; ++tick) {
    clock.advance(kTick_ns);
    std::array<CanFrame, kMaximumBatch> received;
    const std::size_t count = bus.receive(received).received;
    result = bring_up.step(clock.now_ns(), std::span(received).first(count));
    if (result.send) {
      EXPECT_EQ(bus.send(std::span(&result.frame, 1)).sent, 1u);
    }
    if (result.stage == Stage::ready || result.stage == Stage::failed) break;
  }
  return result;
}

inline mit::MitDriver damiao() {
  mit::MitDriver driver;
  driver.command_id = 1;
  driver.reply_id = 0x11;
  driver.layout = mit::ReplyLayout::damiao;
  return driver;
}

inline moteus::MoteusDriver moteus_driver() {
  moteus::MoteusDriver driver;
  driver.kp_Nm_rev = 800;
  driver.kd_Nm_s_rev = 40;
  return driver;
}

inline mit::MitDriver mit_driver(mit::ReplyLayout layout) {
  mit::MitDriver driver = damiao();
  driver.layout = layout;
  return driver;
}

/// An emulated driver around another one: take() decides which frames reach it.
template <class Inner>
class DriverAround : public EmulatedDriver {
 public:
  explicit DriverAround(const Inner& inner) : inner_(inner) {}

  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override { inner_.elapse(now_ns, replies); }
  [[nodiscard]] double torque_Nm() const noexcept override { return inner_.torque_Nm(); }
  [[nodiscard]] bool enabled() const noexcept override { return inner_.enabled(); }
  [[nodiscard]] bool reports_supply() const noexcept override { return inner_.reports_supply(); }
  void raise(DriverFault fault) noexcept override { inner_.raise(fault); }
  void power_cycle() noexcept override { inner_.power_cycle(); }

 protected:
  Inner inner_;
};

class BringUpTest : public ::testing::Test {
 protected:
  mock::MockClock clock_;
  mock::MockBus bus_{clock_};
  Options options_;
};

}  // namespace stilt::hal::bring_up
