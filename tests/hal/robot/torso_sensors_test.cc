#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "hal/canopen/encoder_emulator.h"
#include "hal/robot/can_robot.h"
#include "hal/robot/robot_hardware.h"
#include "hal/robot/wiring_load.h"
#include "tests/hal/hex.h"
#include "tests/hal/robot/emulated_robot.h"

// What measures the pitch when it is no channel, through the robot that reads it.
namespace stilt::hal {
namespace {

using stilt::hal::testing::Kind;
using stilt::hal::testing::kTick_ns;
using stilt::hal::testing::Robot;

/// The emulated encoder at the far end of a mock bus that carries no driver.
class EncoderRig {
 public:
  explicit EncoderRig(const std::function<void(RobotWiring&)>& change = [](RobotWiring&) {})
      : robot_(Kind::mit), wiring_(robot_.wiring_) {
    wiring_.pitch_encoder = canopen::Encoder{.node = 9};
    wiring_.pitch_encoder_bus = 1;
    change(wiring_);
    EXPECT_TRUE(valid(wiring_, 2));
    emulator_.emplace(*wiring_.pitch_encoder);
    hardware_.emplace(wiring_, BringUpOptions{},
                      std::array<FrameBus*, 2>{&robot_.buses_[0], &robot_.buses_[1]});
  }

  void tick() {
    robot_.clock_.advance(kTick_ns);
    robot_.buses_[1].clear_sent();
    hardware_->read(robot_.clock_.now_ns(), readings);
    FrameSink replies;
    emulator_->elapse(robot_.clock_.now_ns(), replies);
    for (const CanFrame& frame : robot_.buses_[1].sent())
      emulator_->take(robot_.clock_.now_ns(), frame, replies);
    if (!connected) return;
    for (const CanFrame& frame : replies.frames())
      robot_.buses_[1].script(frame, robot_.clock_.now_ns() + kTick_ns);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  /// A frame of another sender, on the bus of the channels.
  void send(const CanFrame& frame) { robot_.buses_[0].script(frame, robot_.clock_.now_ns()); }
  void set_pitch(double pitch_rad) {
    const double turns = wiring_.pitch_direction * wiring_.pitch_ratio;
    emulator_->set_motion(turns * (pitch_rad - wiring_.pitch_offset_rad), 0);
  }

  RobotReadings readings;
  bool connected = true;

 private:
  Robot robot_;
  RobotWiring wiring_;
  std::optional<canopen::EncoderEmulator> emulator_;
  std::optional<RobotHardware> hardware_;
};

TEST(TorsoSensors, AnEncoderOnCanopenMeasuresPitchAndRateThroughItsGears) {
  EncoderRig rig([](RobotWiring& wiring) {
    wiring.pitch_direction = -1;
    wiring.pitch_ratio = 3;
    wiring.pitch_offset_rad = 0.2;
  });
  double pitch_rad = -0.3;
  rig.set_pitch(pitch_rad);
  rig.run(150);
  EXPECT_NEAR(rig.readings.base.pitch_rad, pitch_rad, 5e-5);
  for (int i = 0; i < 600; ++i) rig.set_pitch(pitch_rad += 1e-3), rig.tick();
  EXPECT_NEAR(rig.readings.base.pitch_rad, pitch_rad - 1e-3, 5e-5) << "that of the tick before";
  EXPECT_NEAR(rig.readings.base.pitch_rate_rad_s, 1.0, 0.01);
  EXPECT_EQ(rig.readings.base.missed_replies, 0u);
  EXPECT_EQ(rig.readings.base.malformed, 0u);
}

TEST(TorsoSensors, AnEncoderThatFallsSilentIsMissedEveryRead) {
  EncoderRig rig;
  rig.run(150);
  EXPECT_EQ(rig.readings.base.missed_replies, 0u);
  rig.connected = false;
  rig.run(12);
  EXPECT_GE(rig.readings.base.missed_replies, 10u);
}

TEST(TorsoSensors, ASlowerEncoderIsNotMissedBetweenItsPositions) {
  EncoderRig rig([](RobotWiring& wiring) { wiring.channel_period_ticks = 4; });
  rig.run(150);
  for (int i = 0; i < 40; ++i) {
    rig.tick();
    EXPECT_EQ(rig.readings.base.missed_replies, 0u) << i;
  }
}

TEST(TorsoSensors, AChannelBesideAnEncoderIsNotThePitch) {
  EncoderRig rig;  // its wiring has a pitch channel, too
  rig.set_pitch(0.1);
  rig.run(150);
  rig.connected = false;
  rig.run(2);
  CanFrame frame = classic_frame(0x50, 4);
  frame.data = {0xf4, 0x01, 0x01, 0x00};  // 0.5 rad, emergency stop released
  rig.send(frame);
  rig.run(1);
  EXPECT_EQ(rig.readings.emergency_stop, EmergencyStopState::released) << "the frame came";
  EXPECT_NEAR(rig.readings.base.pitch_rad, 0.1, 1e-4);
}

class ScriptedFeed final : public TorsoFeed {
 public:
  [[nodiscard]] const TorsoSample& newest() noexcept override { return sample; }
  TorsoSample sample;
};

TEST(TorsoSensors, ASampleOfAFeedCountsOnce) {
  Robot robot(Kind::mit);
  robot.wiring_.serial_imu.emplace();
  robot.wiring_.channel_period_ticks = 2;
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot sensing(robot.wiring_, buses);
  ScriptedFeed feed;
  sensing.attach(feed);
  const auto read = [&] {
    robot.clock_.advance(kTick_ns);
    static_cast<void>(sensing.read(robot.clock_.now_ns(), robot.readings_));
    BaseReading base;
    static_cast<void>(sensing.read_base(base));
    return base;
  };
  EXPECT_TRUE(std::isnan(read().pitch_rad));
  feed.sample = {.pitch_rad = 0.3, .pitch_rate_rad_s = -2, .time_ns = 77, .number = 1, .malformed = 4};
  BaseReading base = read();
  EXPECT_EQ(base.pitch_rad, 0.3);
  EXPECT_EQ(base.pitch_rate_rad_s, -2);
  EXPECT_EQ(base.time_ns, 77);
  EXPECT_EQ(base.malformed, 4u);
  EXPECT_EQ(base.missed_replies, 0u);
  EXPECT_EQ(read().missed_replies, 0u) << "the next is not due yet";
  base = read();
  EXPECT_EQ(base.missed_replies, 1u) << "the same sample again is nothing new";
  EXPECT_EQ(base.malformed, 4u);
  feed.sample.number = 2;
  feed.sample.pitch_rate_rad_s = std::nan("");
  EXPECT_EQ(read().missed_replies, 2u) << "a pitch without the rate that was due";
  EXPECT_EQ(read().missed_replies, 3u);
}

TEST(TorsoSensors, ARollGoesOnBeyondHalfATurn) {
  Robot robot(Kind::mit);
  robot.wiring_.serial_imu = vectornav::Mounting{.by_roll = true, .direction = 1, .offset_rad = -3.0};
  const std::array<FrameBus*, 2> buses{&robot.buses_[0], &robot.buses_[1]};
  CanRobot sensing(robot.wiring_, buses);
  ScriptedFeed feed;
  sensing.attach(feed);
  const auto pitch_rad = [&](double roll_rad) {
    feed.sample = {.pitch_rad = roll_rad - 3.0, .pitch_rate_rad_s = 0, .number = feed.sample.number + 1};
    robot.clock_.advance(kTick_ns);
    static_cast<void>(sensing.read(robot.clock_.now_ns(), robot.readings_));
    BaseReading base;
    static_cast<void>(sensing.read_base(base));
    return base.pitch_rad;
  };
  EXPECT_NEAR(pitch_rad(3.1), 0.1, 1e-12);
  EXPECT_NEAR(pitch_rad(-3.1), 2 * std::numbers::pi - 6.1, 1e-12);
  EXPECT_NEAR(pitch_rad(3.1), 0.1, 1e-12);
}

TEST(TorsoSensors, AMoteusEncoderWithoutVelocityIsMissed) {
  Robot robot(Kind::moteus);
  robot.set_joint(0, 0, 0);
  const auto tick = [&robot](const char* payload) {
    CanFrame frame;
    frame.id = robot.frame_ids_[0];
    frame.fd = true;
    frame = testing::with_payload(frame, payload);
    robot.clock_.advance(kTick_ns);
    robot.buses_[0].script(frame, robot.clock_.now_ns());
    static_cast<void>(robot.read());
    BaseReading base;
    static_cast<void>(robot.robot_->read_base(base));
    return base;
  };
  // int32 position 0.1 rev of encoder 1 (0x052), and velocity 1 rev/s (0x053): units 1e-5
  EXPECT_EQ(tick("2a5210270000a08601005050").missed_replies, 0u);
  const BaseReading base = tick("2a5211270000000000805050");  // velocity: the integer for "not known"
  EXPECT_NEAR(base.pitch_rad, 0.10001 * 2 * std::numbers::pi, 1e-9);
  EXPECT_EQ(base.missed_replies, 1u);
}

TEST(TorsoSensors, AnEncoderLoadsItsBusAndPassesItsFilter) {
  Robot robot(Kind::mit);
  RobotWiring wiring = robot.wiring_;
  const std::size_t before = periodic_frames(wiring, 1, 1000, 500).size();
  wiring.pitch_encoder = canopen::Encoder{.node = 9};
  wiring.pitch_encoder_bus = 1;
  EXPECT_EQ(periodic_frames(wiring, 0, 1000, 500).size(),
            periodic_frames(robot.wiring_, 0, 1000, 500).size());
  const auto frames = periodic_frames(wiring, 1, 1000, 500);
  ASSERT_EQ(frames.size(), before + 3) << "SYNC, position, heartbeat";
  EXPECT_EQ(frames[before].length, 0);
  EXPECT_EQ(frames[before + 1].length, 4);
  EXPECT_EQ(frames[before + 1].rate_hz, 500);
  const auto ids = receive_ids(wiring, 1);
  for (const std::uint32_t id : {0x189u, 0x589u, 0x709u, 0x080u}) {
    EXPECT_EQ(std::ranges::count(ids, id, &FrameId::id), 1) << id;
  }
}

}  // namespace
}  // namespace stilt::hal
