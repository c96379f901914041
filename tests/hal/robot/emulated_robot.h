#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/mit/mit_bring_up.h"
#include "hal/mit/mit_emulator.h"
#include "hal/moteus/moteus_bring_up.h"
#include "hal/moteus/moteus_emulator.h"
#include "hal/odrive/odrive_bring_up.h"
#include "hal/odrive/odrive_emulator.h"
#include "hal/robot/can_robot.h"
#include "tests/hal/mock/mock_bus.h"

namespace stilt::hal::testing {

inline constexpr std::int64_t kTick_ns = 1'000'000;

enum class Kind { mit, moteus, odrive };

inline std::string kind_name(const ::testing::TestParamInfo<Kind>& parameter) {
  switch (parameter.param) {
    case Kind::mit:
      return "Mit";
    case Kind::moteus:
      return "Moteus";
    case Kind::odrive:
      return "Odrive";
  }
  return "Unknown";
}

inline JointCommands some_commands() {
  JointCommands commands;
  commands.fill({.position_rad = 0.4, .kp_Nm_rad = 100, .kd_Nms_rad = 2, .torque_limit_Nm = 50});
  return commands;
}

/// Two buses, one per leg, with four emulated drivers of one kind and a torso sensor on the first bus. The
/// right knee's motor gives less torque than its driver is asked for.
class Robot {
 public:
  explicit Robot(Kind kind) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      JointWiring& wiring = wiring_.joints[joint];
      wiring.bus = static_cast<std::uint8_t>(joint / 2);
      wiring.direction = joint % 2 == 0 ? 1 : -1;
      wiring.ratio = kind == Kind::odrive ? 8 : 2;
      wiring.offset_rad = 0.25;
      wiring.torque_factor = joint == 3 ? 0.8 : 1;
      const auto number = static_cast<std::uint8_t>(1 + joint % 2);
      if (kind == Kind::mit) {
        mit::MitDriver driver;
        driver.command_id = number;
        driver.reply_id = static_cast<std::uint16_t>(0x10 + number);
        driver.driver_id = number;
        driver.layout = mit::ReplyLayout::damiao;
        wiring.driver = driver;
        drivers_[joint] = std::make_shared<mit::MitEmulator>(make_emulator(driver));
        frame_ids_[joint] = driver.reply_id;
      } else if (kind == Kind::moteus) {
        moteus::MoteusDriver driver;
        driver.id = number;
        driver.kp_Nm_rev = 2000;
        driver.kd_Nm_s_rev = 60;
        if (joint == 0) driver.extra_encoder = 1;
        wiring.driver = driver;
        drivers_[joint] = std::make_shared<moteus::MoteusEmulator>(make_emulator(driver));
        frame_ids_[joint] = static_cast<std::uint32_t>(number) << 8;
      } else {
        const odrive::OdriveDriver driver{number, kEndpoints};
        wiring.driver = driver;
        drivers_[joint] = std::make_shared<odrive::OdriveEmulator>(make_emulator(driver));
        frame_ids_[joint] = static_cast<std::uint32_t>(number) << 5 | 9;
      }
      buses_[wiring.bus].attach(*drivers_[joint]);
    }
    if (kind == Kind::moteus) wiring_.pitch_encoder_joint = 0;
    wiring_.channels[0] = {.id = 0x50, .scale = 1e-3, .channel = BaseChannel::pitch_rad};
    wiring_.channels[1] = {.id = 0x50, .byte_offset = 2, .channel = BaseChannel::emergency_stop_released};
    wiring_.channel_count = 2;
    EXPECT_TRUE(valid(wiring_, 2));
    const std::array<FrameBus*, 2> buses{&buses_[0], &buses_[1]};
    robot_ = std::make_unique<CanRobot>(wiring_, buses);
    enable();
    clock_.advance(kTick_ns);
    static_cast<void>(read());
  }

  JointBusStatus read() { return robot_->read(clock_.now_ns(), readings_); }

  /// Brings every driver up, each feeding its watchdog until all are ready.
  void enable() {
    std::vector<JointBringUp> ups;
    for (const JointWiring& wiring : wiring_.joints) {
      ups.push_back(visit_driver(wiring.driver, [](const auto& driver) -> JointBringUp {
        return make_bring_up(driver, bring_up::Options{});
      }));
    }
    std::size_t ready = 0;
    for (int tick = 0; tick < 1000 && ready < kJoints; ++tick) {
      clock_.advance(kTick_ns);
      std::array<std::array<CanFrame, kMaximumBatch>, 2> received;
      std::array<std::size_t, 2> count{};
      for (std::size_t bus = 0; bus < 2; ++bus) count[bus] = buses_[bus].receive(received[bus]).received;
      ready = 0;
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        const std::size_t bus = wiring_.joints[joint].bus;
        const bring_up::StepResult result = visit_driver(ups[joint], [&](auto& up) {
          return up.step(clock_.now_ns(), std::span(received[bus]).first(count[bus]));
        });
        if (result.send) {
          EXPECT_EQ(buses_[bus].send(std::span(&result.frame, 1)).sent, 1u);
        }
        if (result.stage == bring_up::Stage::ready) ++ready;
      }
    }
    EXPECT_EQ(ready, kJoints);
    for (auto& bus : buses_) bus.clear_sent();
  }

  void set_joint(std::size_t joint, double position_rad, double velocity_rad_s) {
    const JointWiring& wiring = wiring_.joints[joint];
    drivers_[joint]->motor.position_rad =
        wiring.direction * wiring.ratio * (position_rad - wiring.offset_rad);
    drivers_[joint]->motor.velocity_rad_s = wiring.direction * wiring.ratio * velocity_rad_s;
  }
  double joint_torque_Nm(std::size_t joint) const {
    const JointWiring& wiring = wiring_.joints[joint];
    return wiring.direction * wiring.ratio * wiring.torque_factor * drivers_[joint]->torque_Nm();
  }

  static constexpr odrive::OdriveEndpoints kEndpoints{.watchdog_timeout = 0x191,
                                                      .enable_watchdog = 0x192,
                                                      .firmware_version = 0x00060b,
                                                      .hardware_version = 0x04043a};
  mock::MockClock clock_;
  std::array<mock::MockBus, 2> buses_{mock::MockBus(clock_), mock::MockBus(clock_)};
  RobotWiring wiring_;
  std::array<std::shared_ptr<EmulatedDriver>, kJoints> drivers_;
  std::array<std::uint32_t, kJoints> frame_ids_{};
  std::unique_ptr<CanRobot> robot_;
  JointReadings readings_;
};

}  // namespace stilt::hal::testing
