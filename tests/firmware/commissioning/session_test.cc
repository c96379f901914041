#include "firmware/commissioning/session.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "hal/can/socketcan/confirmations.h"
#include "hal/can/socketcan/frame_socket.h"
#include "hal/robot/robot_hardware.h"
#include "tests/hal/can/socketcan/frame_socket_rig.h"

namespace stilt::commissioning {
namespace {

using hal::socketcan::FrameSocket;

static_assert(kLastTicks > hal::socketcan::Confirmations::kOvertaken, "the last frames disable the drivers");

constexpr std::int64_t kTick_ns = 1'000'000;

/// As the kernel delivers echoes: everything received is confirmed as our own.
int receive_as_echo(int descriptor, mmsghdr* headers, unsigned count, int flags, timespec* timeout) {
  const int messages = ::recvmmsg(descriptor, headers, count, flags, timeout);
  for (int i = 0; i < messages; ++i) headers[i].msg_hdr.msg_flags |= MSG_CONFIRM;
  return messages;
}

/// A bus without drivers that carries every frame, and may lose an echo.
class EchoingBus {
 public:
  EchoingBus() {
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0);
    socket.reset(ends_[0]);
    wire_.reset(ends_[1]);
  }
  ~EchoingBus() {
    for (const int end : ends_) ::close(end);
  }
  EchoingBus(const EchoingBus&) = delete;
  EchoingBus& operator=(const EchoingBus&) = delete;

  void carry() {
    for (const hal::CanFrame& frame : hal::socketcan::receive_all(wire_)) {
      carried.push_back(frame);
      if (loses_echo_of == frame.id) {
        loses_echo_of.reset();
        continue;
      }
      EXPECT_EQ(wire_.send(std::span(&frame, 1)).sent, 1u);
    }
  }

  FrameSocket socket{-1, hal::socketcan::Echo::kernel, {.receive_many = receive_as_echo}};
  std::vector<hal::CanFrame> carried;
  std::optional<std::uint32_t> loses_echo_of;  ///< once

 private:
  int ends_[2] = {-1, -1};
  FrameSocket wire_;
};

/// Buses carry what was sent while it sleeps.
class TestClock final : public hal::Clock {
 public:
  explicit TestClock(std::span<EchoingBus> buses = {}) : buses_(buses) {}
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  [[nodiscard]] std::int64_t sleep_until(std::int64_t time_ns) noexcept override {
    now_ns_ = std::max(now_ns_, time_ns);
    for (EchoingBus& bus : buses_) bus.carry();
    return now_ns_;
  }
  void advance(std::int64_t duration_ns) { now_ns_ += duration_ns; }

 private:
  std::span<EchoingBus> buses_;
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST(Session, DisablesADriverAlsoWhenTheEchoOfItsLastCommandIsLost) {
  const hal::RobotWiring wiring =
      configuration::robot_wiring(configuration::load_robot("amber3m").value().hardware);
  for (const hal::JointWiring& joint : wiring.joints) {
    std::array<EchoingBus, 2> buses;
    hal::RobotHardware hardware(wiring, hal::BringUpOptions{},
                                std::array<hal::FrameBus*, 2>{&buses[0].socket, &buses[1].socket});
    TestClock clock(buses);
    const std::atomic<bool> stop = false;
    Session session(hardware, clock, kTick_ns, stop);
    for (int tick = 0; tick < 5; ++tick) session.tick();
    hal::CanFrame off;
    ASSERT_EQ(disable_frame(std::get<hal::mit::MitDriver>(joint.driver), off), hal::EncodeStatus::ok);
    EchoingBus& bus = buses[joint.bus];
    bus.loses_echo_of = off.id;
    session.disable();
    static_cast<void>(clock.sleep_until(clock.now_ns() + kTick_ns));
    EXPECT_FALSE(bus.loses_echo_of) << "lost";
    const auto last = std::find_if(bus.carried.rbegin(), bus.carried.rend(),
                                   [&](const hal::CanFrame& frame) { return frame.id == off.id; });
    ASSERT_NE(last, bus.carried.rend());
    EXPECT_EQ(*last, off) << off.id;
  }
}

/// At rest at 0, its drivers well.
class StillRobot final : public hal::Robot {
 public:
  void read(std::int64_t now_ns, hal::RobotReadings& readings) noexcept override {
    for (hal::JointReading& joint : readings.joints) {
      joint.position_rad = joint.velocity_rad_s = 0;
      joint.time_ns = now_ns - reading_age_ns;
      joint.missed_replies = missed_replies;
      joint.state = state;
    }
    readings.buses = buses;
    readings.emergency_stop = emergency_stop;
  }
  [[nodiscard]] hal::JointBusStatus write(const hal::JointCommands&) noexcept override {
    return hal::JointBusStatus::ok;
  }
  [[nodiscard]] hal::JointBusStatus disable() noexcept override { return hal::JointBusStatus::ok; }
  void begin_bring_up() noexcept override {}
  [[nodiscard]] hal::BringUpProgress bring_up(std::int64_t) noexcept override { return progress; }
  void restore_buses() noexcept override {}

  std::uint32_t missed_replies = 0;
  std::int64_t reading_age_ns = 0;
  hal::DriverState state = hal::DriverState::enabled;
  hal::BusStates buses;
  hal::EmergencyStopState emergency_stop = hal::EmergencyStopState::released;
  hal::BringUpProgress progress{.ready = true};
};

TEST(Session, ALoopThatStoodStillWhileAJointHadTorqueIsTrouble) {
  StillRobot robot;
  TestClock clock;
  const std::atomic<bool> stop = false;
  Session session(robot, clock, kTick_ns, stop, {.stall_s = 0.010});
  const auto trouble_after = [&](const hal::JointCommand& command, std::int64_t stall_ns) {
    hal::JointCommands commands{};
    commands[2] = command;
    session.tick(commands);
    clock.advance(stall_ns);
    session.tick();
    return session.trouble_with_torque();
  };
  const std::string stood_still =
      "the loop stood still for 0.100 s while a joint had torque, and supervisor.torque_loop_stall_s is "
      "0.01: ";
  for (const hal::JointCommand& command :
       {hal::JointCommand{.torque_Nm = -1}, {.kp_Nm_rad = 10}, {.kd_Nms_rad = 1}}) {
    EXPECT_EQ(trouble_after(command, 0), "");
    EXPECT_EQ(trouble_after(command, 9 * kTick_ns), "");
    EXPECT_TRUE(trouble_after(command, 100 * kTick_ns).starts_with(stood_still))
        << session.trouble_with_torque();
    session.tick();
    EXPECT_EQ(session.trouble_with_torque(), "") << "over";
  }
  EXPECT_EQ(trouble_after({}, 100 * kTick_ns), "") << "limp";
}

TEST(Session, ADriverThatReportsWhileNoCommandLeavesIsNotCalledSilent) {
  StillRobot robot;
  TestClock clock;
  const std::atomic<bool> stop = false;
  Session session(robot, clock, kTick_ns, stop);
  robot.missed_replies = kSilentReads;
  session.tick();
  EXPECT_EQ(session.trouble(), "");
  robot.missed_replies = kSilentReads + 1;
  session.tick();
  EXPECT_EQ(session.trouble(), "no command leaves for the driver of hip_L: look at the adapter of its bus");
  robot.reading_age_ns = (kSilentReads + 1) * kTick_ns;
  session.tick();
  EXPECT_EQ(session.trouble(), "driver of hip_L is silent");
}

/// All that is on it is silent, perhaps the emergency stop, too.
TEST(Session, ABusThatIsGoneOrOffIsNamedBeforeWhatIsOnIt) {
  const std::pair<hal::BusStates, std::string> rows[] = {
      {{.gone = 1}, "bus 0 of hardware.buses is gone: "},
      {{.off = 1, .gone = 2}, "bus 0 of hardware.buses is off, after too many errors: "},
      {{.off = 2}, "bus 1 of hardware.buses is off, after too many errors: "},
      {{.gone = 2}, "bus 1 of hardware.buses is gone: "}};
  for (const auto& [buses, sentence] : rows) {
    StillRobot robot;
    TestClock clock;
    const std::atomic<bool> stop = false;
    Session session(robot, clock, kTick_ns, stop);
    ASSERT_TRUE(session.bring_up());
    session.tick();
    EXPECT_EQ(session.trouble_with_torque(), "");
    robot.buses = buses;
    robot.missed_replies = kSilentReads + 1;
    robot.emergency_stop = hal::EmergencyStopState::unknown;
    session.tick();
    EXPECT_TRUE(session.trouble().starts_with(sentence)) << session.trouble();
    EXPECT_TRUE(session.trouble_with_torque().starts_with(sentence)) << session.trouble_with_torque();
    robot.progress = {.failed = true, .failure = hal::bring_up::Failure::silent};
    const auto up = session.bring_up();
    ASSERT_FALSE(up);
    EXPECT_TRUE(up.error().starts_with(sentence)) << up.error();
  }
}

/// An AK of version 3 reports once that it has started again.
TEST(Session, ADriverThatWasIdleSinceItsBringUpIsNamedUntilTheNext) {
  StillRobot robot;
  TestClock clock;
  const std::atomic<bool> stop = false;
  Session session(robot, clock, kTick_ns, stop);
  const auto trouble_with = [&](hal::DriverState state) {
    robot.state = state;
    session.tick();
    return session.trouble();
  };
  EXPECT_EQ(trouble_with(hal::DriverState::idle), "") << "nothing has enabled it yet";
  ASSERT_TRUE(session.bring_up());
  EXPECT_EQ(trouble_with(hal::DriverState::enabled), "");
  EXPECT_EQ(trouble_with(hal::DriverState::unknown), "") << "some drivers report no state";
  const std::string disabled = "driver of hip_L was disabled or has restarted: begin anew";
  EXPECT_EQ(trouble_with(hal::DriverState::idle), disabled);
  EXPECT_EQ(trouble_with(hal::DriverState::unknown), disabled);
  ASSERT_TRUE(session.bring_up());
  EXPECT_EQ(trouble_with(hal::DriverState::enabled), "");
}

}  // namespace
}  // namespace stilt::commissioning
