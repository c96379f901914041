#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "hal/can/socketcan/frame_socket.h"
#include "tests/hal/can/socketcan/frame_socket_rig.h"

// Commands wait for the echoes of those before them, and not for echoes that are lost.
namespace stilt::hal::socketcan {
namespace {

/// As the kernel delivers echoes: everything received is confirmed as our own.
int receive_as_echo(int descriptor, mmsghdr* headers, unsigned count, int flags, timespec* timeout) {
  const int messages = ::recvmmsg(descriptor, headers, count, flags, timeout);
  for (int i = 0; i < messages; ++i) headers[i].msg_hdr.msg_flags |= MSG_CONFIRM;
  return messages;
}

/// The same, but error frames are the controller's.
int receive_as_echo_unless_error(int descriptor, mmsghdr* headers, unsigned count, int flags,
                                 timespec* timeout) {
  const int messages = ::recvmmsg(descriptor, headers, count, flags, timeout);
  for (int i = 0; i < messages; ++i) {
    std::uint32_t id = 0;
    std::memcpy(&id, headers[i].msg_hdr.msg_iov->iov_base, sizeof id);
    if ((id & CAN_ERR_FLAG) == 0) headers[i].msg_hdr.msg_flags |= MSG_CONFIRM;
  }
  return messages;
}

TEST_F(FrameSocketTest, AtMostOneCommandOfAnIdentifierIsUnconfirmed) {
  FrameSocket reporting(ends_[1]);
  const CanFrame passive = error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
  ASSERT_EQ(reporting.send(std::span(&passive, 1)).sent, 1u);
  FrameSocket socket(ends_[0], Echo::kernel, {.receive_many = receive_as_echo_unless_error});
  FrameSocket wire(ends_[1]);
  const std::vector<CanFrame> commands{classic_frame(1, 8), classic_frame(2, 8)};
  ASSERT_EQ(socket.send(commands).status, BusStatus::ok);
  EXPECT_EQ(socket.unconfirmed(), 2u);
  EXPECT_TRUE(receive_all(socket).empty());
  ASSERT_EQ(socket.health(), BusHealth::passive);
  for (int tick = 0; tick < 50; ++tick) {  // drivers without power: no node acknowledges
    const SendResult result = socket.send(commands);
    EXPECT_EQ(result.sent, 0u);
    EXPECT_EQ(result.status, BusStatus::unconfirmed);
  }
  EXPECT_EQ(socket.counters().withheld, 100u);
  const std::vector<CanFrame> on_the_wire = receive_all(wire);
  EXPECT_EQ(on_the_wire.size(), 2u) << "power returns: one frame per joint, no burst";
  ASSERT_EQ(wire.send(std::span(on_the_wire).first(1)).sent, 1u);  // the first leaves the controller: echo
  EXPECT_TRUE(receive_all(socket).empty()) << "an echo is no reply";
  EXPECT_EQ(socket.counters().confirmed, 1u);
  const SendResult result = socket.send(commands);
  EXPECT_EQ(result.sent, 1u);
  EXPECT_EQ(receive_all(wire), std::vector<CanFrame>{classic_frame(1, 8)});
}

/// A queue that another program keeps full but for one place.
int send_one(int descriptor, mmsghdr* headers, unsigned /*count*/, int flags) {
  return ::sendmmsg(descriptor, headers, 1, flags);
}

TEST_F(FrameSocketTest, AQueueWithOnePlaceATickSilencesNoJointForLongerThanATick) {
  FrameSocket socket(ends_[0], Echo::kernel, {.receive_many = receive_as_echo, .send_many = send_one});
  FrameSocket wire(ends_[1]);
  const std::vector<CanFrame> commands{classic_frame(1, 8), classic_frame(2, 8), classic_frame(3, 8)};
  const CanFrame question = classic_frame(9, 0);
  std::vector<std::uint32_t> sent;
  for (int tick = 0; tick < 30; ++tick) {
    EXPECT_EQ(socket.send(commands).status, BusStatus::queue_full);
    static_cast<void>(socket.send(std::span(&question, 1)));
    for (const CanFrame& frame : receive_all(wire)) {
      if (frame.id != question.id) sent.push_back(frame.id);
      ASSERT_EQ(wire.send(std::span(&frame, 1)).sent, 1u);  // it has left: echo
    }
    EXPECT_TRUE(receive_all(socket).empty());
  }
  ASSERT_EQ(sent.size(), 30u);
  for (std::size_t tick = 0; tick < sent.size(); ++tick) EXPECT_EQ(sent[tick], 1 + tick % 3) << tick;
}

TEST_F(FrameSocketTest, ALostEchoSilencesAJointForAFewTicksOnly) {
  for (const bool passive : {false, true}) {
    FrameSocket socket(ends_[0], Echo::kernel, {.receive_many = receive_as_echo_unless_error});
    FrameSocket wire(ends_[1]);
    const CanFrame state = error_frame(CAN_ERR_CRTL, passive ? CAN_ERR_CRTL_TX_PASSIVE : CAN_ERR_CRTL_ACTIVE);
    ASSERT_EQ(wire.send(std::span(&state, 1)).sent, 1u);
    static_cast<void>(receive_all(socket));
    const std::vector<CanFrame> commands{classic_frame(1, 8), classic_frame(2, 8)};
    int silent = 0;
    for (int tick = 0; tick < 20; ++tick) {
      static_cast<void>(socket.send(commands));
      const std::vector<CanFrame> on_the_wire = receive_all(wire);
      const bool first_sent = !on_the_wire.empty() && on_the_wire[0].id == 1;
      if (!first_sent) ++silent;
      for (const CanFrame& frame : on_the_wire) {
        const bool echo_lost = tick == 0 && frame.id == 1;
        if (echo_lost) continue;
        ASSERT_EQ(wire.send(std::span(&frame, 1)).sent, 1u);
      }
      static_cast<void>(receive_all(socket));
    }
    EXPECT_EQ(silent, 6) << "fewer than supervisor.missed_damp_ticks; passive: " << passive;
    EXPECT_EQ(socket.counters().echoes_lost, 1u);
    EXPECT_EQ(socket.counters().withheld, 6u);
  }
}

/// Sends two commands per tick; what the bus carries comes back as echoes, unless they are lost.
class TwoCommands {
 public:
  explicit TwoCommands(const int (&ends)[2])
      : socket(ends[0], Echo::kernel, {.receive_many = receive_as_echo}), wire_(ends[1]) {}

  /// @return  how many frames the bus carried
  std::size_t tick(bool echoes_come) {
    static_cast<void>(socket.send(commands_));
    const std::vector<CanFrame> carried = receive_all(wire_);
    if (echoes_come && !carried.empty()) {
      EXPECT_EQ(wire_.send(carried).sent, carried.size());
    }
    static_cast<void>(receive_all(socket));
    return carried.size();
  }

  FrameSocket socket;

 private:
  FrameSocket wire_;
  std::vector<CanFrame> commands_{classic_frame(1, 8), classic_frame(2, 8)};
};

TEST_F(FrameSocketTest, ABusThatLosesAllEchoesOfATickIsSilentForAFewTicksOnly) {
  TwoCommands bus(ends_);
  std::vector<int> silent;
  for (int tick = 0; tick < 40; ++tick) {
    if (bus.tick(tick != 10) == 0) silent.push_back(tick);
  }
  EXPECT_EQ(silent, (std::vector<int>{11, 12, 13, 14, 15, 16})) << "fewer than supervisor.missed_damp_ticks";
  EXPECT_EQ(bus.socket.counters().echoes_lost, 2u);
}

TEST_F(FrameSocketTest, ABusThatLosesAllEchoesForATimeGoesOnByItself) {
  for (const int lost_for : {2, 7, 20, 44}) {
    TwoCommands bus(ends_);
    for (int tick = 0; tick < lost_for; ++tick) static_cast<void>(bus.tick(false));
    for (int tick = 0; tick < 25; ++tick) static_cast<void>(bus.tick(true));
    for (int tick = 0; tick < 20; ++tick) EXPECT_EQ(bus.tick(true), 2u) << lost_for;
  }
}

TEST_F(FrameSocketTest, ABusWithoutEchoesHoldsFewFramesOfAnIdentifierAndAResetTriesAgain) {
  TwoCommands bus(ends_);
  std::size_t carried = 0;
  for (int tick = 0; tick < 5000; ++tick) carried += bus.tick(false);
  EXPECT_EQ(carried, 2 * (1 + Confirmations::kTries)) << "no burst when the power returns";
  EXPECT_EQ(bus.tick(true), 0u) << "nothing is sent, so nothing comes back";
  bus.socket.clear_bus_off();
  for (int tick = 0; tick < 20; ++tick) EXPECT_EQ(bus.tick(true), 2u);
}

TEST_F(FrameSocketTest, AResetSendsNothingBesideACommandThatWaitsForAFewTicks) {
  TwoCommands bus(ends_);
  EXPECT_EQ(bus.tick(false), 2u);
  EXPECT_EQ(bus.tick(false), 0u);
  bus.socket.clear_bus_off();
  EXPECT_EQ(bus.tick(false), 0u);
}

TEST_F(FrameSocketTest, AFullTableLetsAnIdentifierThroughWhoseEchoIsGivenUp) {
  FrameSocket socket(ends_[0], Echo::kernel);
  std::vector<CanFrame> commands;
  for (std::uint32_t id = 0; id < Confirmations::kCapacity; ++id) commands.push_back(classic_frame(id, 1));
  ASSERT_EQ(socket.send(commands).sent, Confirmations::kCapacity);
  const std::span<const CanFrame> first(commands.data(), 1);
  for (int tick = 0; tick < 6; ++tick) ASSERT_EQ(socket.send(first).sent, 0u);
  EXPECT_EQ(socket.send(first).sent, 1u);
  EXPECT_EQ(socket.send(first).sent, 0u);
}

TEST_F(FrameSocketTest, FramesThatLeaveByPriorityLoseNoEcho) {
  FrameSocket socket(ends_[0], Echo::kernel, {.receive_many = receive_as_echo});
  FrameSocket wire(ends_[1]);
  std::vector<CanFrame> commands;
  for (std::uint32_t id = 1; id <= 6; ++id) commands.push_back(classic_frame(id, 8));
  for (int tick = 0; tick < 10; ++tick) {
    ASSERT_EQ(socket.send(commands).sent, commands.size()) << tick;
    std::vector<CanFrame> on_the_wire = receive_all(wire);
    std::ranges::reverse(on_the_wire);
    ASSERT_EQ(wire.send(on_the_wire).sent, on_the_wire.size());
    static_cast<void>(receive_all(socket));
  }
  EXPECT_EQ(socket.counters().echoes_lost, 0u);
}

}  // namespace
}  // namespace stilt::hal::socketcan
