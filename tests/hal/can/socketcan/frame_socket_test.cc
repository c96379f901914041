#include "hal/can/socketcan/frame_socket.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "tests/hal/can/socketcan/frame_socket_rig.h"
#include "tests/hal/random_values.h"

namespace stilt::hal::socketcan {
namespace {

using stilt::hal::testing::RandomValues;

TEST_F(FrameSocketTest, FramesArriveInOrderAndUnchanged) {
  constexpr std::uint64_t kSeed = 4601;
  SCOPED_TRACE(kSeed);
  RandomValues random(kSeed);
  FrameSocket sender(ends_[0]);
  FrameSocket receiver(ends_[1]);
  std::vector<CanFrame> sent;
  for (int batch = 0; batch < 200; ++batch) {
    std::vector<CanFrame> frames;
    while (frames.size() < 1 + random.below(kMaximumBatch)) {
      CanFrame frame = random.frame();
      if (!well_formed(frame) || frame.error) continue;
      std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{0});
      frames.push_back(frame);
    }
    const SendResult result = sender.send(frames);
    ASSERT_EQ(result.status, BusStatus::ok);
    ASSERT_EQ(result.sent, frames.size());
    ASSERT_EQ(receive_all(receiver), frames);
    sent.insert(sent.end(), frames.begin(), frames.end());
  }
  EXPECT_EQ(sender.counters().sent, sent.size());
  EXPECT_EQ(receiver.counters().received, sent.size());
}

TEST_F(FrameSocketTest, ReceiveNeverWaitsAndReportsWhenMoreIsThere) {
  FrameSocket sender(ends_[0]);
  FrameSocket receiver(ends_[1]);
  std::array<CanFrame, 4> frames;
  EXPECT_EQ(receiver.receive(frames).received, 0u);
  const std::vector<CanFrame> six(6, classic_frame(1, 8));
  ASSERT_EQ(sender.send(six).sent, 6u);
  ReceiveResult result = receiver.receive(frames);
  EXPECT_EQ(result.received, 4u);
  EXPECT_EQ(result.status, BusStatus::more);
  result = receiver.receive(frames);
  EXPECT_EQ(result.received, 2u);
  EXPECT_EQ(result.status, BusStatus::ok);
}

TEST_F(FrameSocketTest, AFrameNoBusCanCarryIsDroppedAloneAndCounted) {
  FrameSocket sender(ends_[0]);
  FrameSocket receiver(ends_[1]);
  std::vector<CanFrame> frames(3, classic_frame(1, 8));
  frames[1].length = 9;
  const SendResult result = sender.send(frames);
  EXPECT_EQ(result.sent, 2u);
  EXPECT_EQ(result.status, BusStatus::malformed);
  EXPECT_EQ(sender.counters().malformed, 1u);
  EXPECT_EQ(receive_all(receiver).size(), 2u);
}

TEST_F(FrameSocketTest, BytesThatAreNoFrameAreCountedAndSkipped) {
  FrameSocket receiver(ends_[1]);
  const std::array<std::byte, 100> noise{};
  ASSERT_EQ(::send(ends_[0], noise.data(), 5, 0), 5);
  ASSERT_EQ(::send(ends_[0], noise.data(), 100, 0), 100);
  FrameSocket sender(ends_[0]);
  const CanFrame frame = classic_frame(7, 1);
  ASSERT_EQ(sender.send(std::span(&frame, 1)).sent, 1u);
  EXPECT_EQ(receive_all(receiver).size(), 1u);
  EXPECT_EQ(receiver.counters().malformed, 2u);
}

TEST_F(FrameSocketTest, AFullQueueIsCountedAndNeverFatal) {
  FrameSocket sender(ends_[0]);
  FrameSocket receiver(ends_[1]);
  const std::vector<CanFrame> batch(kMaximumBatch, classic_frame(1, 8));
  SendResult result;
  int batches = 0;
  do {
    result = sender.send(batch);
    ASSERT_LT(++batches, 10'000);
  } while (result.status == BusStatus::ok);
  EXPECT_EQ(result.status, BusStatus::queue_full);
  EXPECT_GT(sender.counters().dropped_full, 0u);
  EXPECT_EQ(sender.counters().sent + sender.counters().dropped_full,
            static_cast<std::uint64_t>(batches) * batch.size());
  EXPECT_EQ(receive_all(receiver).size(), sender.counters().sent);
  EXPECT_EQ(sender.send(batch).status, BusStatus::ok) << "works again when there is room";
}

int no_buffers(int, mmsghdr*, unsigned, int) {
  errno = ENOBUFS;
  return -1;
}

TEST_F(FrameSocketTest, EnobufsIsAFullQueue) {
  FrameSocket sender(ends_[0], Echo::none, {.send_many = no_buffers});
  const CanFrame frame = classic_frame(1, 8);
  EXPECT_EQ(sender.send(std::span(&frame, 1)).status, BusStatus::queue_full);
  EXPECT_EQ(sender.counters().dropped_full, 1u);
  EXPECT_TRUE(sender.connected());
}

int too_long(int, mmsghdr*, unsigned, int) {
  errno = EMSGSIZE;
  return -1;
}
int no_device(int, mmsghdr*, unsigned, int) {
  errno = ENODEV;
  return -1;
}

TEST_F(FrameSocketTest, AFrameTheInterfaceCannotCarryIsNamedAndAVanishedInterfaceIsADisconnection) {
  const CanFrame frame = classic_frame(1, 8);
  FrameSocket classic(ends_[0], Echo::none, {.send_many = too_long});
  EXPECT_EQ(classic.send(std::span(&frame, 1)).status, BusStatus::malformed);
  EXPECT_EQ(classic.counters().malformed, 1u);
  EXPECT_EQ(classic.counters().dropped_full, 0u);
  EXPECT_TRUE(classic.connected());
  FrameSocket unplugged(ends_[0], Echo::none, {.send_many = no_device});
  EXPECT_EQ(unplugged.send(std::span(&frame, 1)).status, BusStatus::disconnected);
  EXPECT_FALSE(unplugged.connected());
  EXPECT_EQ(unplugged.counters().disconnections, 1u);
}

TEST_F(FrameSocketTest, TooLongABatchIsCutAndCounted) {
  FrameSocket sender(ends_[0]);
  const std::vector<CanFrame> frames(kMaximumBatch + 3, classic_frame(1, 8));
  const SendResult result = sender.send(frames);
  EXPECT_EQ(result.sent, kMaximumBatch);
  EXPECT_EQ(result.status, BusStatus::queue_full);
  EXPECT_EQ(sender.counters().dropped_full, 3u);
}

TEST_F(FrameSocketTest, AClosedPeerIsADisconnectionOnce) {
  FrameSocket socket(ends_[0]);
  FrameSocket peer(ends_[1]);
  const CanFrame frame = classic_frame(1, 8);
  ASSERT_EQ(peer.send(std::span(&frame, 1)).sent, 1u);
  close_end(1);
  std::array<CanFrame, 4> frames;
  const ReceiveResult last = socket.receive(frames);
  EXPECT_EQ(last.received, 1u) << "what was sent before is delivered";
  EXPECT_EQ(last.status, BusStatus::disconnected);
  EXPECT_EQ(socket.receive(frames).status, BusStatus::disconnected);
  EXPECT_EQ(socket.send(std::span(&frame, 1)).status, BusStatus::disconnected);
  EXPECT_EQ(socket.counters().disconnections, 1u);
}

TEST_F(FrameSocketTest, WithoutADescriptorItIsDisconnected) {
  FrameSocket socket;
  std::array<CanFrame, 1> frames;
  EXPECT_EQ(socket.receive(frames).status, BusStatus::disconnected);
  EXPECT_EQ(socket.send(frames).status, BusStatus::disconnected);
}

TEST_F(FrameSocketTest, TwoFramesOfOneIdentifierInABatchAreOneTooMany) {
  FrameSocket socket(ends_[0], Echo::kernel);
  const std::vector<CanFrame> twice(2, classic_frame(1, 8));
  const SendResult result = socket.send(twice);
  EXPECT_EQ(result.sent, 1u);
  EXPECT_EQ(result.status, BusStatus::unconfirmed);
}

TEST_F(FrameSocketTest, MarkedEchoesConfirmAndUnmarkedFramesAreReplies) {
  FrameSocket socket(ends_[0], Echo::marked);
  FrameSocket peer(ends_[1]);
  const CanFrame command = classic_frame(1, 8);
  ASSERT_EQ(socket.send(std::span(&command, 1)).sent, 1u);
  WireFrame wire;
  const std::size_t bytes = to_wire(command, wire);
  mark_echo(wire);
  ASSERT_EQ(::send(ends_[1], wire.data(), bytes, 0), static_cast<ssize_t>(bytes));
  ASSERT_EQ(peer.send(std::span(&command, 1)).sent, 1u);
  EXPECT_EQ(receive_all(socket).size(), 1u);
  EXPECT_EQ(socket.counters().confirmed, 1u);
  EXPECT_EQ(socket.unconfirmed(), 0u);
}

/// As the kernel reports frames it dropped: seven so far.
int receive_with_overflow(int descriptor, mmsghdr* headers, unsigned count, int flags, timespec* timeout) {
  const int messages = ::recvmmsg(descriptor, headers, count, flags, timeout);
  for (int i = 0; i < messages; ++i) {
    msghdr& header = headers[i].msg_hdr;
    header.msg_controllen = CMSG_SPACE(sizeof(std::uint32_t));
    auto* control = static_cast<cmsghdr*>(header.msg_control);
    control->cmsg_level = SOL_SOCKET;
    control->cmsg_type = SO_RXQ_OVFL;
    control->cmsg_len = CMSG_LEN(sizeof(std::uint32_t));
    const std::uint32_t total = 7;
    std::memcpy(CMSG_DATA(control), &total, sizeof total);
  }
  return messages;
}

TEST_F(FrameSocketTest, FramesTheKernelDroppedAreCountedAndEndTheWaitForEchoes) {
  FrameSocket socket(ends_[0], Echo::kernel, {.receive_many = receive_with_overflow});
  FrameSocket peer(ends_[1]);
  const CanFrame command = classic_frame(1, 8);
  ASSERT_EQ(socket.send(std::span(&command, 1)).sent, 1u);
  const std::vector<CanFrame> replies(2, classic_frame(0x10, 8));
  ASSERT_EQ(peer.send(replies).sent, 2u);
  EXPECT_EQ(receive_all(socket).size(), 2u);
  EXPECT_EQ(socket.counters().dropped_received, 7u) << "the total counts once";
  EXPECT_EQ(socket.send(std::span(&command, 1)).status, BusStatus::ok) << "the echo may be among the dropped";
}

TEST_F(FrameSocketTest, BusOffIsAFaultThatAnAutomaticRestartDoesNotUndo) {
  FrameSocket socket(ends_[0], Echo::kernel);
  FrameSocket peer(ends_[1]);
  const std::vector<CanFrame> off_and_restarted{error_frame(CAN_ERR_BUSOFF), error_frame(CAN_ERR_RESTARTED),
                                                error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE)};
  ASSERT_EQ(peer.send(off_and_restarted).sent, 3u);
  EXPECT_TRUE(receive_all(socket).empty()) << "error frames are not delivered";
  EXPECT_EQ(socket.health(), BusHealth::off);
  EXPECT_EQ(socket.counters().bus_off, 1u);
  EXPECT_EQ(socket.counters().error_frames, 3u);
  socket.clear_bus_off();
  EXPECT_EQ(socket.health(), BusHealth::active);
}

TEST_F(FrameSocketTest, ABusThatWentOffNeverEchoesAndTheNextCommandsGoOut) {
  FrameSocket socket(ends_[0], Echo::kernel);
  FrameSocket peer(ends_[1]);
  const CanFrame command = classic_frame(1, 8);
  ASSERT_EQ(socket.send(std::span(&command, 1)).sent, 1u);
  ASSERT_EQ(socket.send(std::span(&command, 1)).status, BusStatus::unconfirmed);
  const CanFrame off = error_frame(CAN_ERR_BUSOFF);
  ASSERT_EQ(peer.send(std::span(&off, 1)).sent, 1u);
  static_cast<void>(receive_all(socket));
  EXPECT_EQ(socket.unconfirmed(), 0u);
  socket.clear_bus_off();
  EXPECT_EQ(socket.send(std::span(&command, 1)).status, BusStatus::ok);
}

// Linux, drivers/net/can/dev: a restart flushes the echo queue, so that frames accepted meanwhile never come
// back.
TEST_F(FrameSocketTest, FramesThatARestartFlushesDoNotSilenceTheirIdentifier) {
  for (const bool reported : {true, false}) {
    FrameSocket bus(ends_[0], Echo::marked);
    FrameSocket controller(ends_[1]);
    const CanFrame command = classic_frame(1, 8);
    const CanFrame off = error_frame(CAN_ERR_BUSOFF);
    const CanFrame restarted = error_frame(CAN_ERR_RESTARTED);
    ASSERT_EQ(controller.send(std::span(&off, 1)).sent, 1u);
    static_cast<void>(receive_all(bus));
    ASSERT_EQ(bus.send(std::span(&command, 1)).sent, 1u) << "the kernel takes it, and flushes it";
    ASSERT_EQ(bus.send(std::span(&command, 1)).sent, 0u);
    if (reported) {
      ASSERT_EQ(controller.send(std::span(&restarted, 1)).sent, 1u);
      static_cast<void>(receive_all(bus));
    } else {
      bus.clear_bus_off();
    }
    EXPECT_EQ(bus.send(std::span(&command, 1)).sent, 1u) << reported;
    static_cast<void>(receive_all(controller));
  }
}

TEST_F(FrameSocketTest, AnotherDescriptorStartsWithNothingUnconfirmedAndKeepsTheCounters) {
  FrameSocket socket(ends_[0], Echo::kernel);
  const CanFrame command = classic_frame(1, 8);
  ASSERT_EQ(socket.send(std::span(&command, 1)).sent, 1u);
  close_end(1);
  static_cast<void>(receive_all(socket));
  ASSERT_FALSE(socket.connected());
  ASSERT_EQ(socket.counters().disconnections, 1u);
  close_end(0);
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0);
  socket.reset(ends_[0]);
  EXPECT_TRUE(socket.connected());
  EXPECT_EQ(socket.unconfirmed(), 0u);
  EXPECT_EQ(socket.send(std::span(&command, 1)).status, BusStatus::ok);
  EXPECT_EQ(socket.counters().sent, 2u);
  EXPECT_EQ(socket.counters().disconnections, 1u);
  ASSERT_EQ(socket.unconfirmed(), 1u);
  socket.reset(ends_[0]);
  EXPECT_EQ(socket.unconfirmed(), 0u) << "also without a loss before";
}

TEST_F(FrameSocketTest, SoManyUnconfirmedCommandsAsTheTableHoldsAndNoMore) {
  FrameSocket socket(ends_[0], Echo::kernel);
  std::vector<CanFrame> commands;
  for (std::uint32_t id = 0; id < Confirmations::kCapacity; ++id) commands.push_back(classic_frame(id, 1));
  EXPECT_EQ(socket.send(commands).sent, Confirmations::kCapacity);
  const CanFrame one_more = classic_frame(0x100, 1);
  EXPECT_EQ(socket.send(std::span(&one_more, 1)).status, BusStatus::unconfirmed);
}

TEST_F(FrameSocketTest, WarningAndPassiveFollowTheController) {
  FrameSocket socket(ends_[0]);
  FrameSocket peer(ends_[1]);
  const auto health_after = [&](std::uint8_t detail) {
    const CanFrame frame = error_frame(CAN_ERR_CRTL, detail);
    EXPECT_EQ(peer.send(std::span(&frame, 1)).sent, 1u);
    static_cast<void>(receive_all(socket));
    return socket.health();
  };
  EXPECT_EQ(health_after(CAN_ERR_CRTL_TX_WARNING), BusHealth::warning);
  EXPECT_EQ(health_after(CAN_ERR_CRTL_RX_PASSIVE), BusHealth::passive);
  EXPECT_EQ(health_after(CAN_ERR_CRTL_ACTIVE), BusHealth::active);
}

}  // namespace
}  // namespace stilt::hal::socketcan
