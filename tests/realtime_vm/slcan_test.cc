#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <linux/tty.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

#include "hal/can/socketcan/descriptor.h"
#include "hal/can/socketcan/socketcan_bus.h"

// CAN adapters that speak slcan over a serial line, of which the test plays the adapter. It shows what the
// kernel does with an interface whose controller goes off the bus, and with one that is unplugged. Runs as
// root beside the program ip.
namespace stilt::hal::socketcan {
namespace {

void shell(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

/// Waits up to two seconds for something to read.
bool readable(int descriptor) {
  pollfd waiting{descriptor, POLLIN, 0};
  return ::poll(&waiting, 1, 2000) > 0;
}

class Slcan : public ::testing::Test {
 protected:
  void SetUp() override {
    adapter_ = Descriptor(::posix_openpt(O_RDWR | O_NOCTTY));
    ASSERT_TRUE(adapter_.open());
    ASSERT_EQ(::grantpt(adapter_.get()), 0);
    ASSERT_EQ(::unlockpt(adapter_.get()), 0);
    line_ = Descriptor(::open(::ptsname(adapter_.get()), O_RDWR | O_NOCTTY));
    ASSERT_TRUE(line_.open());
    const int discipline = N_SLCAN;
    ASSERT_EQ(::ioctl(line_.get(), TIOCSETD, &discipline), 0);
    std::array<char, IFNAMSIZ> name{};
    ASSERT_EQ(::ioctl(line_.get(), SIOCGIFNAME, name.data()), 0);
    interface_ = name.data();
    shell("ip link set " + interface_ + " up");
    ASSERT_TRUE(bus_.open(interface_, {}));
  }

  void write(const std::string& text) const {
    ASSERT_EQ(::write(adapter_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// The next line that begins so.
  std::string line_from_kernel(char first) const {
    std::string line;
    for (char byte = 0; readable(adapter_.get()) && ::read(adapter_.get(), &byte, 1) == 1;) {
      if (byte != '\r') {
        line += byte;
      } else if (!line.empty() && line[0] == first) {
        return line;
      } else {
        line.clear();
      }
    }
    return line;
  }
  /// Takes what comes until the condition holds, at most 20 times.
  template <class Condition>
  bool comes(const Condition& condition) {
    for (int tries = 0; tries < 20 && !condition(); ++tries) {
      static_cast<void>(readable(bus_.frames().descriptor()));
      received_ = bus_.frames().receive(frames_);
    }
    return condition();
  }

  Descriptor adapter_;
  Descriptor line_;
  std::string interface_;
  SocketCanBus bus_;
  std::array<CanFrame, kMaximumBatch> frames_;
  ReceiveResult received_;
};

TEST_F(Slcan, FramesPassBothWaysAndCommandsAreConfirmed) {
  CanFrame command = classic_frame(1, 2);
  command.data[1] = 0xa5;
  ASSERT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::ok);
  EXPECT_EQ(line_from_kernel('t'), "t001200A5");
  EXPECT_TRUE(comes([&] { return bus_.frames().unconfirmed() == 0; }));
  write("t01121234\r");
  ASSERT_TRUE(comes([&] { return received_.received == 1; }));
  EXPECT_EQ(frames_[0].id, 0x11u);
  EXPECT_EQ(frames_[0].data[1], 0x34);
}

TEST_F(Slcan, AControllerThatGoesOffTheBusIsAFaultAndTheNextCommandsGoOutAfterwards) {
  const CanFrame command = classic_frame(1, 8);
  write("sb256256\r");
  ASSERT_TRUE(comes([&] { return bus_.frames().health() == BusHealth::off; }));
  EXPECT_EQ(bus_.frames().counters().bus_off, 1u);
  static_cast<void>(bus_.frames().send(std::span(&command, 1)));  // while it is off
  shell("ip link set " + interface_ + " down");
  static_cast<void>(bus_.frames().send(std::span(&command, 1)));
  EXPECT_TRUE(comes([&] { return !bus_.frames().connected(); }));
  shell("ip link set " + interface_ + " up");
  ASSERT_TRUE(bus_.reopen());
  bus_.frames().clear_bus_off();
  EXPECT_EQ(bus_.frames().send(std::span(&command, 1)).status, BusStatus::ok);
  EXPECT_EQ(line_from_kernel('t'), "t00180000000000000000");
  EXPECT_EQ(bus_.frames().health(), BusHealth::active);
}

TEST_F(Slcan, AnAdapterThatIsUnpluggedIsADisconnection) {
  adapter_ = Descriptor();
  const CanFrame command = classic_frame(1, 8);
  EXPECT_TRUE(comes([&] {
    static_cast<void>(bus_.frames().send(std::span(&command, 1)));
    return !bus_.frames().connected();
  }));
  EXPECT_FALSE(bus_.reopen());
}

}  // namespace
}  // namespace stilt::hal::socketcan
