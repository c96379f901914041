#include "hal/can/socketcan/socketcan_bus.h"

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "hal/any_bus.h"

namespace stilt::hal::socketcan {
namespace {

bool kernel_has_can() {
  const int descriptor = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (descriptor < 0) return false;
  ::close(descriptor);
  return true;
}

TEST(SocketCanBus, ANameThatIsNoInterfaceIsRefusedInOneSentence) {
  SocketCanBus bus;
  const auto opened = bus.open("an-interface-name-too-long", {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(),
            "bus 'an-interface-name-too-long': an interface name has 1 to 15 characters, like can0");
}

TEST(SocketCanBus, AKernelWithoutCanPointsToLoopback) {
  if (kernel_has_can()) GTEST_SKIP() << "this kernel has CAN";
  AnyBus bus;
  const auto opened = bus.open("can0", {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(),
            "bus can0: this kernel has no CAN (module can-raw); without hardware use loopback:NAME");
  EXPECT_FALSE(bus.reconnect()) << "and nothing else is opened instead";
}

TEST(SocketCanBus, AnInterfaceOfClassicFramesNamesWhatNeedsCanFd) {
  EXPECT_TRUE(classic_sentence("can0", {})
                  .starts_with("bus can0: the interface carries no CAN FD frames, which a moteus "
                               "and can_fd = true need; set it up with `dbitrate 5000000 "))
      << classic_sentence("can0", {});
}

/// Needs an interface vcan0 that is up: `ip link add vcan0 type vcan && ip link set vcan0 up`.
class VirtualCan : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kernel_has_can()) GTEST_SKIP() << "this kernel has no CAN";
    const BusOptions options{.receive_ids = {{0x11, false}, {0x01, false}}};
    if (!bus_.open("vcan0", options)) GTEST_SKIP() << "there is no interface vcan0 that is up";
    ASSERT_TRUE(other_.open("vcan0", {}));
  }

  static ReceiveResult receive(SocketCanBus& bus, std::span<CanFrame> frames) {
    pollfd waiting{bus.frames().descriptor(), POLLIN, 0};
    static_cast<void>(::poll(&waiting, 1, 1000));
    return bus.frames().receive(frames);
  }

  SocketCanBus bus_;
  SocketCanBus other_;
};

TEST_F(VirtualCan, FiltersPassRepliesAndEchoesOnly) {
  const std::array<CanFrame, 2> replies{classic_frame(0x12, 8), classic_frame(0x11, 8)};
  ASSERT_EQ(other_.frames().send(replies).sent, 2u);
  std::array<CanFrame, 8> frames;
  ASSERT_EQ(receive(bus_, frames).received, 1u);
  EXPECT_EQ(frames[0].id, 0x11u);
  const CanFrame command = classic_frame(0x01, 8);
  ASSERT_EQ(bus_.frames().send(std::span(&command, 1)).sent, 1u);
  EXPECT_EQ(receive(bus_, frames).received, 0u);
  EXPECT_EQ(bus_.frames().counters().confirmed, 1u);
}

TEST_F(VirtualCan, AnInjectedErrorFrameReadsAsBusOff) {
  CanFrame off;
  off.error = true;
  off.id = CAN_ERR_BUSOFF;
  off.length = 8;
  ASSERT_EQ(other_.frames().send(std::span(&off, 1)).sent, 1u);
  std::array<CanFrame, 8> frames;
  EXPECT_EQ(receive(bus_, frames).received, 0u);
  EXPECT_EQ(bus_.frames().health(), BusHealth::off);
}

}  // namespace
}  // namespace stilt::hal::socketcan
