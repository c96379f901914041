#include "hal/ak/ak_driver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hal/robot/wiring_load.h"
#include "tests/hal/ak/ak_rig.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::ak {
namespace {

using mock::FrameFault;

CanFrame status_of(const AkDriver& driver, const AkStatus& status) {
  CanFrame frame;
  EXPECT_EQ(encode_status(driver, status, frame), EncodeStatus::ok);
  return frame;
}

CanFrame position_of(const AkDriver& driver, double position_rad) {
  CanFrame frame;
  EXPECT_EQ(encode_position(driver, position_rad, 4, frame), EncodeStatus::ok);
  return frame;
}

/// Takes a frame as CanRobot does.
DecodeStatus take(const AkDriver& driver, const CanFrame& frame, DriverReading& reading) {
  reading.begin_frame();
  return take_frame(driver, frame, reading);
}

TEST(AkDriver, AStatusIsAReadingOfTheOutput) {
  const AkDriver driver;
  DriverReading reading;
  ASSERT_EQ(
      take(driver,
           status_of(driver,
                     {.position_rad = 0.5, .velocity_rad_s = -2, .current_A = 3, .driver_temperature_C = 41}),
           reading),
      DecodeStatus::ok);
  EXPECT_TRUE(reading.has_motion);
  EXPECT_NEAR(reading.position_rad, 0.5, 0.1 * kDegree);
  EXPECT_NEAR(reading.velocity_rad_s, -2, 0.006);
  EXPECT_EQ(reading.driver_temperature_C, 41);
  EXPECT_TRUE(std::isnan(reading.torque_Nm)) << "without a constant";
  EXPECT_TRUE(std::isnan(reading.motor_temperature_C));
  EXPECT_EQ(reading.state, DriverState::unknown) << "it does not say whether it is on";
}

TEST(AkDriver, TheTorqueHasTheSignOfItsConstant) {
  for (const double constant_Nm_A : {0.57, -0.57}) {
    const AkDriver driver{.torque_constant_Nm_A = constant_Nm_A};
    DriverReading reading;
    static_cast<void>(take(driver, status_of(driver, {.current_A = 2}), reading));
    EXPECT_NEAR(reading.torque_Nm, 2 * constant_Nm_A, 1e-9);
  }
}

TEST(AkDriver, AFaultADisableAndAStartShowInTheState) {
  const AkDriver driver;
  DriverReading reading;
  static_cast<void>(take(driver, status_of(driver, {.code = 2}), reading));
  EXPECT_EQ(reading.state, DriverState::fault);
  EXPECT_EQ(reading.fault, DriverFault::over_current);
  EXPECT_EQ(reading.fault_code, 2u);
  static_cast<void>(take(driver, status_of(driver, {.disabled = true}), reading));
  EXPECT_EQ(reading.state, DriverState::idle) << "somebody else has disabled it";
  EXPECT_EQ(reading.fault, DriverFault::none);
  static_cast<void>(take(driver, status_of(driver, {}), reading));
  EXPECT_EQ(reading.state, DriverState::unknown);
  ASSERT_EQ(take(driver, start_frame(driver), reading), DecodeStatus::ok);
  EXPECT_EQ(reading.state, DriverState::idle) << "its command is gone";
  EXPECT_FALSE(reading.has_motion);
}

TEST(AkDriver, APositionFrameRefinesTheStatusInEitherOrder) {
  const AkDriver driver{.position_frames = true};
  constexpr double kFirst_rad = 0.50013, kSecond_rad = 0.52013;
  DriverReading reading;
  const auto expect_position = [&](const CanFrame& frame, double position_rad, double step_rad) {
    ASSERT_EQ(take(driver, frame, reading), DecodeStatus::ok);
    EXPECT_TRUE(reading.has_motion);
    EXPECT_NEAR(reading.position_rad, position_rad, step_rad);
  };
  expect_position(status_of(driver, {.position_rad = kFirst_rad}), kFirst_rad, kAkStatusStep_rad);
  expect_position(position_of(driver, kFirst_rad), kFirst_rad, kAkPositionStep_rad);
  // The joint has moved: what refined the position before is not kept.
  expect_position(status_of(driver, {.position_rad = kSecond_rad}), kSecond_rad, kAkStatusStep_rad);
  expect_position(position_of(driver, kSecond_rad), kSecond_rad, kAkPositionStep_rad);
  expect_position(status_of(driver, {.position_rad = kSecond_rad}), kSecond_rad, kAkPositionStep_rad);
  // The other order.
  expect_position(position_of(driver, kFirst_rad), kFirst_rad, kAkPositionStep_rad);
  expect_position(status_of(driver, {.position_rad = kFirst_rad, .velocity_rad_s = 3}), kFirst_rad,
                  kAkPositionStep_rad);
  EXPECT_NEAR(reading.velocity_rad_s, 3, 0.006);
}

TEST(AkDriver, PositionFramesWithoutStatusesAreNoReadings) {
  const AkDriver driver{.position_frames = true};
  DriverReading reading;
  ASSERT_EQ(take(driver, position_of(driver, 0.5), reading), DecodeStatus::ok);
  EXPECT_FALSE(reading.has_motion) << "no velocity yet";
  static_cast<void>(take(driver, status_of(driver, {.position_rad = 0.5, .velocity_rad_s = 3}), reading));
  static_cast<void>(take(driver, position_of(driver, 0.5), reading));
  EXPECT_TRUE(reading.has_motion);
  static_cast<void>(take(driver, position_of(driver, 0.506), reading));
  EXPECT_FALSE(reading.has_motion) << "the velocity is old";
  static_cast<void>(take(driver, status_of(driver, {.position_rad = 0.51}), reading));
  EXPECT_TRUE(reading.has_motion);
}

TEST(AkDriver, APositionFrameThatCountsFromElsewhereIsLeftAside) {
  const AkDriver driver{.position_frames = true};
  DriverReading reading;
  static_cast<void>(take(driver, status_of(driver, {.position_rad = 0.5}), reading));
  ASSERT_EQ(take(driver, position_of(driver, 0.5 + 360 * kDegree), reading), DecodeStatus::ok);
  EXPECT_FALSE(reading.has_motion);
  EXPECT_NEAR(reading.position_rad, 0.5, 0.1 * kDegree);
  const AkDriver coarse;
  reading = {};
  static_cast<void>(take(coarse, status_of(coarse, {.position_rad = 0.5}), reading));
  ASSERT_EQ(take(coarse, position_of(coarse, 0.5007), reading), DecodeStatus::ok);
  EXPECT_FALSE(reading.has_motion) << "not asked for by the configuration";
}

TEST(AkDriver, FramesOfAnotherIdentifierAreNotAddressed) {
  DriverReading reading;
  const AkDriver other{.id = 105};
  for (const CanFrame& frame :
       {status_of(other, {}), position_of(other, 0), start_frame(other), origin_frame({}, true)}) {
    EXPECT_EQ(take({}, frame, reading), DecodeStatus::not_addressed);
  }
}

TEST(AkDriver, ItsIdentifiersAreTheExtendedOnesThatEndInItsOwn) {
  const auto collide = [](const AkDriver& driver, std::uint32_t id, bool extended) {
    return !collisions(identifiers(driver), identifiers(ChannelRow{.id = id, .extended = extended})).empty();
  };
  const AkDriver driver{.id = 0x10};
  for (const std::uint32_t mode : {0u, 5u, 8u, 0xfu, 0x10u, 0x29u, 0x2au, 0x2cu}) {
    EXPECT_TRUE(collide(driver, mode << 8 | 0x10, true)) << mode;
    EXPECT_FALSE(collide(driver, mode << 8 | 0x11, true)) << mode;
  }
  EXPECT_FALSE(collide(driver, 0x10, false)) << "it takes no short ones";
  EXPECT_FALSE(collide(driver, 0x2d10, true));
  EXPECT_FALSE(collisions(identifiers(driver), identifiers(AkDriver{.id = 0x10})).empty());
  EXPECT_TRUE(collisions(identifiers(driver), identifiers(AkDriver{.id = 0x11})).empty());
  for (const FrameId& id : receive_ids(driver)) {
    EXPECT_TRUE(id.extended);
    EXPECT_EQ(id.id & 0xff, 0x10u);
  }
}

TEST(AkDriver, ABusOfTwoIsHighAndOneOfFourIsRefused) {
  for (const auto& [position_frames, fraction] : {std::pair{false, 0.480}, {true, 0.640}}) {
    AkRobot robot({.position_frames = position_frames});
    const auto frames = periodic_frames(robot.wiring_, 1, 1000, 0);
    EXPECT_NEAR(bus_load(frames, {}).fraction, fraction, 0.002);
    for (JointWiring& joint : robot.wiring_.joints) joint.bus = 0;
    EXPECT_EQ(bus_load(periodic_frames(robot.wiring_, 0, 1000, 0), {}).verdict, BusLoadVerdict::refused);
  }
}

TEST(AkRobotReadings, TheTorqueAtTheOutputFollowsTheLawOfTheCommand) {
  constexpr std::uint64_t kSeed = 5201;
  SCOPED_TRACE(kSeed);
  stilt::hal::testing::RandomValues random(kSeed);
  for (const bool whole_scale : {false, true}) {
    AkRobot robot({}, {.whole_scale = whole_scale});
    for (int i = 0; i < 300; ++i) {
      JointCommands commands;
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        commands[joint] = {random.between(-0.1, 0.1), random.between(-1, 1), random.between(-5, 5),
                           random.between(0, 60),     random.between(0, 3),  100};
        robot.drivers_[joint]->motor.position_rad = random.between(-0.1, 0.1);
        robot.drivers_[joint]->motor.velocity_rad_s = random.between(-1, 1);
      }
      robot.tick(commands);
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        const auto& motor = robot.drivers_[joint]->motor;
        const JointCommand& command = commands[joint];
        const double expected_Nm = command.torque_Nm +
                                   command.kp_Nm_rad * (command.position_rad - motor.position_rad) +
                                   command.kd_Nms_rad * (command.velocity_rad_s - motor.velocity_rad_s);
        ASSERT_NEAR(robot.drivers_[joint]->torque_Nm(), expected_Nm, 0.2) << joint;
      }
    }
  }
}

/// With clocks that run fast, like ours, and slow, for 20 s of reads.
TEST(AkRobotReadings, NothingIsMissedWhateverTheDriversClockDoes) {
  for (const double rate_hz : {500.0, 333.0, 250.0, 100.0}) {
    for (const double clock_error : {-1e-2, -1e-4, 0.0, 1e-4, 1e-2}) {
      AkRobot robot({.status_rate_hz = rate_hz}, {.clock_error = clock_error});
      for (int i = 0; i < 20; ++i) robot.tick();
      for (int i = 0; i < 20'000; ++i) {
        ASSERT_EQ(robot.tick(), JointBusStatus::ok) << rate_hz << ", " << clock_error << ", " << i;
        for (const JointReading& reading : robot.readings_) ASSERT_EQ(reading.missed_replies, 0u);
      }
    }
  }
}

TEST(AkRobotReadings, ALostReportIsAMissAndTwoHoldThePose) {
  constexpr std::uint32_t kHold = 3;  // supervisor.missed_hold_ticks
  for (const int lost : {1, 2}) {
    AkRobot robot;
    for (int i = 0; i < 50 || robot.readings_[1].time_ns != robot.clock_.now_ns(); ++i) robot.tick();
    const std::int64_t now_ns = robot.clock_.now_ns();
    robot.buses_[0].add_fault({.fault = FrameFault::lose,
                               .id = 0x2902,
                               .any_id = false,
                               .from_ns = now_ns,
                               .until_ns = now_ns + 2'000'000 * lost + 500'000});
    std::uint32_t missed = 0;
    for (int i = 0; i < 20; ++i) {
      robot.tick();
      missed = std::max(missed, robot.readings_[1].missed_replies);
      EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
    }
    EXPECT_GT(missed, 0u);
    EXPECT_EQ(missed >= kHold, lost == 2) << missed;
    EXPECT_EQ(robot.readings_[1].missed_replies, 0u) << "over";
  }
}

TEST(AkRobotReadings, ASilentDriverIsLostAsSoonAsAnyOther) {
  AkRobot robot;
  for (int i = 0; i < 50; ++i) robot.tick();
  robot.drivers_[3]->set_powered(false);
  int ticks = 0;
  while (robot.readings_[3].missed_replies < 10 && ticks < 100) {
    const bool incomplete = robot.tick() == JointBusStatus::incomplete;
    EXPECT_EQ(ticks > 0 && robot.readings_[3].missed_replies > 0, incomplete) << ticks;
    ++ticks;
  }
  EXPECT_GE(ticks, 11);
  EXPECT_LE(ticks, 13) << "10 reads, and 2 until the first was due";
}

/// It would go on with its last torque, and reports all the same.
TEST(AkRobotReadings, CommandsThatDoNotLeaveAreMissesOfTheirBusAlone) {
  AkRobot robot;
  for (int i = 0; i < 50; ++i) robot.tick();
  robot.buses_[0].set_queue_full(true);
  for (std::uint32_t miss = 1; miss <= 12; ++miss) {
    robot.tick();
    for (std::size_t joint = 0; joint < kJoints; ++joint)
      EXPECT_EQ(robot.readings_[joint].missed_replies, joint < 2 ? miss : 0u) << joint;
  }
  robot.buses_[0].set_queue_full(false);
  robot.buses_[0].clear_sent();
  robot.robot_->clear_faults();
  EXPECT_TRUE(robot.buses_[0].sent().empty()) << "they are not silent";
  robot.tick();
  for (const JointReading& reading : robot.readings_) EXPECT_EQ(reading.missed_replies, 0u);
}

TEST(AkRobotReadings, WhereNothingIsCommandedNoCommandIsMissed) {
  AkRobot robot;
  for (int i = 0; i < 50; ++i) robot.tick();
  robot.buses_[0].set_queue_full(true);
  for (int i = 0; i < 5; ++i) robot.tick();
  EXPECT_EQ(robot.readings_[0].missed_replies, 5u);
  robot.clock_.advance(kTick_ns);
  static_cast<void>(robot.robot_->read(robot.clock_.now_ns(), robot.readings_));
  EXPECT_EQ(robot.readings_[0].missed_replies, 0u);
}

/// Takes one frame of a batch, of one joint after the other, as an adapter with slow echoes.
class SlowBus final : public FrameBus {
 public:
  explicit SlowBus(FrameBus& inner) : inner_(inner) {}
  [[nodiscard]] SendResult send(std::span<const CanFrame> frames) noexcept override {
    return {inner_.send(frames.subspan(turn_++ % frames.size(), 1)).sent, BusStatus::unconfirmed};
  }
  [[nodiscard]] ReceiveResult receive(std::span<CanFrame> frames) noexcept override {
    return inner_.receive(frames);
  }
  [[nodiscard]] BusHealth health() const noexcept override { return inner_.health(); }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const BusCounters& counters() const noexcept override { return inner_.counters(); }

 private:
  FrameBus& inner_;
  std::size_t turn_ = 0;
};

TEST(AkRobotReadings, CommandsThatLeaveByTurnsAreNotMissed) {
  AkRobot robot;
  for (int i = 0; i < 50; ++i) robot.tick();
  SlowBus slow(robot.buses_[0]);
  robot.robot_ = std::make_unique<CanRobot>(robot.wiring_, std::array<FrameBus*, 2>{&slow, &robot.buses_[1]});
  for (int i = 0; i < 50; ++i) {
    robot.tick();
    if (i < 5) continue;  // until the first report is due
    for (const JointReading& reading : robot.readings_) ASSERT_EQ(reading.missed_replies, 0u) << i;
  }
}

/// At every phase of its report: where a status follows in the same read, too.
TEST(AkRobotReadings, AStartShowsInItsReadWhateverFollows) {
  for (const double rate_hz : {500.0, 333.0}) {
    AkRobot robot({.status_rate_hz = rate_hz});
    for (int i = 0; i < 20; ++i) robot.tick();
    bool together = false;
    for (int phase = 0; phase < 60; ++phase) {
      robot.drivers_[2]->power_cycle();
      robot.tick();
      EXPECT_EQ(robot.readings_[2].state, DriverState::idle) << rate_hz << ", " << phase;
      together = together || robot.readings_[2].time_ns == robot.clock_.now_ns();
      EXPECT_EQ(robot.readings_[0].state, DriverState::unknown);
      for (int i = 0; i < 4 + phase % 3; ++i) robot.tick();
      EXPECT_EQ(robot.readings_[2].state, DriverState::unknown) << "not for ever";
    }
    EXPECT_TRUE(together) << "a status in the read of the start";
  }
}

/// Code 0x77 comes once. A computer that was late reads the next status with it.
TEST(AkRobotReadings, ADisableShowsInItsReadWhateverFollows) {
  const AkDriver first{.id = 1};
  for (const bool then_faulty : {false, true}) {
    AkRobot robot;
    for (int i = 0; i < 20; ++i) robot.tick();
    const std::int64_t due_ns = robot.clock_.now_ns() + kTick_ns;
    robot.buses_[0].script(status_of(first, {.disabled = true}), due_ns);
    robot.buses_[0].script(status_of(first, then_faulty ? AkStatus{.code = 2} : AkStatus{}), due_ns);
    robot.tick();
    EXPECT_EQ(robot.readings_[0].state, then_faulty ? DriverState::fault : DriverState::idle);
    for (int i = 0; i < 3; ++i) robot.tick();
    EXPECT_EQ(robot.readings_[0].state, DriverState::unknown);
  }
}

TEST(AkRobotReadings, NoFrameIsSentThatTheDriverCouldMisread) {
  AkRobot robot;
  for (int i = 0; i < 10; ++i) robot.tick();
  EXPECT_EQ(robot.robot_->disable(), JointBusStatus::ok);
  robot.drivers_[0]->raise(DriverFault::over_current);
  for (int i = 0; i < 5; ++i) robot.tick();
  robot.robot_->clear_faults();
  for (const mock::MockBus& bus : robot.buses_) {
    EXPECT_GT(bus.sent().size(), 20u);
    for (const CanFrame& frame : bus.sent()) {
      EXPECT_TRUE(frame.extended);
      EXPECT_EQ(frame.id >> 8, 8u);
      EXPECT_EQ(frame.length, 8);
      EXPECT_FALSE(
          std::all_of(frame.data.begin(), frame.data.begin() + 7, [](auto byte) { return byte == 0xff; }));
    }
  }
}

TEST(AkRobotReadings, ADisabledRobotIsLimpForEver) {
  AkRobot robot;
  JointCommands commands;
  commands.fill({.position_rad = 0.4, .kp_Nm_rad = 50, .kd_Nms_rad = 2, .torque_limit_Nm = 50});
  robot.tick(commands);
  EXPECT_GT(robot.drivers_[0]->torque_Nm(), 10);
  EXPECT_EQ(robot.robot_->disable(), JointBusStatus::ok);
  robot.clock_.advance(10 * kTick_ns);
  static_cast<void>(robot.robot_->read(robot.clock_.now_ns(), robot.readings_));
  for (const auto& driver : robot.drivers_) {
    EXPECT_FALSE(driver->enabled());
    EXPECT_LE(std::abs(driver->torque_Nm()), 18.0 / 4095);
  }
}

}  // namespace
}  // namespace stilt::hal::ak
