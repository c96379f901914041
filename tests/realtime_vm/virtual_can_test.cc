#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <poll.h>

#include <array>
#include <cstdlib>
#include <string>

#include "hal/any_bus.h"
#include "hal/can/socketcan/socketcan_bus.h"

// The kernel's own CAN, which only the virtual machine has: queues that fill, interfaces that go, error
// frames. Runs as root beside the programs ip and tc, with interfaces vcan0 and vcan1.
namespace stilt::hal::socketcan {
namespace {

void shell(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

/// Waits up to a second for frames. Nothing arriving in time fails the test that needs it, never the
/// reverse.
ReceiveResult receive(SocketCanBus& bus, std::span<CanFrame> frames) {
  pollfd waiting{bus.frames().descriptor(), POLLIN, 0};
  static_cast<void>(::poll(&waiting, 1, 1000));
  return bus.frames().receive(frames);
}

CanFrame error_frame(std::uint32_t kind, std::size_t byte = 0, std::uint8_t value = 0) {
  CanFrame frame;
  frame.error = true;
  frame.id = kind;
  frame.length = 8;
  frame.data[byte] = value;
  return frame;
}

class KernelCan : public ::testing::Test {
 protected:
  void SetUp() override {
    shell("ip link set vcan1 up");
    ASSERT_TRUE(bus_.open("vcan1", {.receive_ids = {{0x11, false}, {0x01, false}}, .fd = true}));
    ASSERT_TRUE(other_.open("vcan1", {.receive_ids = {}, .fd = true}));
  }

  void inject(const CanFrame& frame) {
    SocketCanBus injector;  // anew each time: no node confirms an error frame
    ASSERT_TRUE(injector.open("vcan1", {}));
    ASSERT_EQ(injector.frames().send(std::span(&frame, 1)).sent, 1u);
    std::array<CanFrame, 8> frames;
    EXPECT_EQ(receive(bus_, frames).received, 0u);
  }

  SocketCanBus bus_;
  SocketCanBus other_;
};

TEST_F(KernelCan, ClassicAndFlexibleFramesArriveAsTheyLeft) {
  CanFrame classic = classic_frame(0x11, 3);
  classic.data[2] = 0xa5;
  CanFrame flexible = classic_frame(0x11, 8);
  flexible.fd = true;
  flexible.length = 48;
  for (std::uint8_t i = 0; i < 48; ++i) flexible.data[i] = i;
  for (const CanFrame& sent : {classic, flexible}) {
    ASSERT_EQ(other_.frames().send(std::span(&sent, 1)).sent, 1u);
    std::array<CanFrame, 8> frames;
    ASSERT_EQ(receive(bus_, frames).received, 1u);
    EXPECT_EQ(frames[0].fd, sent.fd);
    EXPECT_EQ(frames[0].length, sent.length);
    EXPECT_EQ(frames[0].data, sent.data);
    static_cast<void>(receive(other_, frames));  // its echo, so that the next one may leave
  }
}

TEST_F(KernelCan, ErrorFramesShowInTheHealthOfTheBus) {
  inject(error_frame(CAN_ERR_CRTL, 1, CAN_ERR_CRTL_TX_WARNING));
  EXPECT_EQ(bus_.frames().health(), BusHealth::warning);
  inject(error_frame(CAN_ERR_CRTL, 1, CAN_ERR_CRTL_TX_PASSIVE));
  EXPECT_EQ(bus_.frames().health(), BusHealth::passive);
  EXPECT_EQ(bus_.frames().counters().error_frames, 2u);
}

TEST_F(KernelCan, BusOffStaysThroughTheRestartUntilItIsCleared) {
  inject(error_frame(CAN_ERR_BUSOFF));
  inject(error_frame(CAN_ERR_RESTARTED));
  EXPECT_EQ(bus_.frames().health(), BusHealth::off);
  EXPECT_EQ(bus_.frames().counters().bus_off, 1u);
  bus_.frames().clear_bus_off();
  EXPECT_EQ(bus_.frames().health(), BusHealth::active);
}

TEST_F(KernelCan, AFullQueueDropsAndCountsAndGoesOn) {
  shell("tc qdisc add dev vcan1 root netem delay 200ms limit 4");
  std::array<CanFrame, 12> frames;
  for (std::uint32_t i = 0; i < frames.size(); ++i) frames[i] = classic_frame(0x100 + i, 8);
  const SendResult result = bus_.frames().send(frames);
  EXPECT_EQ(result.status, BusStatus::queue_full);
  EXPECT_LT(result.sent, frames.size());
  EXPECT_EQ(result.sent + bus_.frames().counters().dropped_full, frames.size());
  shell("tc qdisc del dev vcan1 root");
  const CanFrame later = classic_frame(0x300, 8);
  EXPECT_EQ(bus_.frames().send(std::span(&later, 1)).status, BusStatus::ok);
}

TEST_F(KernelCan, ACommandIsWithheldWhileItsPredecessorIsStillInTheQueue) {
  shell("tc qdisc add dev vcan1 root netem delay 200ms limit 100");
  const CanFrame command = classic_frame(0x01, 8);
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::ok);
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::unconfirmed);
  EXPECT_EQ(bus_.frames().counters().withheld, 1u);
  std::array<CanFrame, 8> frames;
  for (int tries = 0; tries < 100 && bus_.frames().unconfirmed() > 0; ++tries) {
    static_cast<void>(receive(bus_, frames));
  }
  EXPECT_EQ(bus_.frames().counters().confirmed, 1u) << "it left at last";
  shell("tc qdisc del dev vcan1 root");
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::ok);
}

TEST_F(KernelCan, AnInterfaceThatGoesDownIsDisconnectedUntilItIsOpenedAgain) {
  shell("ip link set vcan1 down");
  const CanFrame command = classic_frame(0x01, 8);
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::disconnected);
  EXPECT_FALSE(bus_.reopen());
  shell("ip link set vcan1 up");
  EXPECT_TRUE(bus_.reopen());
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::ok);
  EXPECT_EQ(bus_.frames().counters().disconnections, 1u);
}

/// Bitrate, sample points and jump widths: moteus, docs/platforms/socketcan.md ("all must be configured").
/// The jump width at 40 MHz: the kernel's can_sjw_check().
const std::string kMoteusTiming =
    "`dbitrate 5000000 fd on sample-point 0.666 dsample-point 0.666 sjw 10 dsjw 5`, or `dsjw 2` where `ip "
    "-details "
    "link show vcan1` shows clock 40000000";

TEST_F(KernelCan, AnInterfaceThatIsDownIsRefusedInOneSentence) {
  shell("ip link set vcan1 down");
  AnyBus bus;
  const auto opened = bus.open("vcan1", {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(
      opened.error(),
      "bus vcan1: the interface is down; bring it up with `ip link set vcan1 up type can bitrate 1000000`, "
      "with CAN FD also " +
          kMoteusTiming);
}

TEST_F(KernelCan, AnInterfaceOfClassicFramesIsRefusedForCanFdWithTheBitTimingOfAMoteus) {
  shell("ip link set vcan1 down && ip link set vcan1 mtu 16 up");
  AnyBus bus;
  const auto opened = bus.open("vcan1", {.receive_ids = {}, .fd = true});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(),
            "bus vcan1: the interface carries no CAN FD frames, which a moteus and can_fd = true need; set "
            "it up with " +
                kMoteusTiming);
  EXPECT_TRUE(bus.open("vcan1", {}));
  shell("ip link set vcan1 down && ip link set vcan1 mtu 72 up");
}

}  // namespace
}  // namespace stilt::hal::socketcan
