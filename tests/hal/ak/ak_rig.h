#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <numbers>
#include <span>

#include "hal/ak/ak_driver.h"
#include "hal/ak/ak_emulator.h"
#include "hal/robot/can_robot.h"
#include "tests/hal/mock/mock_bus.h"

namespace stilt::hal::ak {

inline constexpr std::int64_t kTick_ns = 1'000'000;
inline constexpr double kDegree = std::numbers::pi / 180;

/// Four emulated drivers on two buses, read at 1 kHz. All that is sent is kept in the buses.
class AkRobot {
 public:
  explicit AkRobot(const AkDriver& kind = {}, const AkBehaviour& behaviour = {})
      : AkRobot(kind, documented_settings(kind), behaviour) {}
  AkRobot(const AkDriver& kind, const AkSettings& settings, const AkBehaviour& behaviour) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      AkDriver driver = kind;
      driver.id = static_cast<std::uint8_t>(1 + joint);
      JointWiring& wiring = wiring_.joints[joint];
      wiring.bus = static_cast<std::uint8_t>(joint / 2);
      wiring.driver = driver;
      wiring.report_period_ticks = report_period_ticks(wiring.driver, 1000);
      drivers_[joint] = std::make_unique<AkEmulator>(driver, settings, behaviour);
      buses_[wiring.bus].attach(*drivers_[joint]);
    }
    EXPECT_TRUE(valid(wiring_, 2));
    robot_ = std::make_unique<CanRobot>(wiring_, std::array<FrameBus*, 2>{&buses_[0], &buses_[1]});
  }

  JointBusStatus tick(const JointCommands& commands = {}) {
    static_cast<void>(robot_->write(commands));
    clock_.advance(kTick_ns);
    return robot_->read(clock_.now_ns(), readings_);
  }

  mock::MockClock clock_;
  std::array<mock::MockBus, 2> buses_{mock::MockBus(clock_), mock::MockBus(clock_)};
  RobotWiring wiring_;
  std::array<std::unique_ptr<AkEmulator>, kJoints> drivers_;
  std::unique_ptr<CanRobot> robot_;
  JointReadings readings_;
};

}  // namespace stilt::hal::ak
