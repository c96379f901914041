#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <vector>

#include "hal/can/socketcan/frame_socket.h"
#include "hal/can/socketcan/wire_frame.h"
#include "tests/hal/random_values.h"

// Our end of a bus against what a CAN interface of the kernel does with frames: they wait in its queue, a few
// are with the controller, each that has left comes back as an echo. Bus-off and restart drop both without an
// echo (drivers/net/can/dev: can_bus_off, can_restart, can_flush_echo_skb), and a queue without carrier takes
// frames and frees them.
namespace stilt::hal::socketcan {
namespace {

using stilt::hal::testing::RandomValues;

class Interface {
 public:
  Interface(int descriptor, std::size_t mailboxes) : descriptor_(descriptor), mailboxes_(mailboxes) {}

  struct OnWire {
    CanFrame frame;
    int sent_tick = 0;
  };

  /// At most so many frames leave; an echo is lost with this probability.
  std::vector<OnWire> send_some(int most, double loss, RandomValues& random) {
    std::vector<OnWire> wire;
    for (int i = 0; i < most && carrier_; ++i) {
      while (with_controller_.size() < mailboxes_ && !queue_.empty()) {
        with_controller_.push_back(queue_.front());
        queue_.pop_front();
      }
      if (with_controller_.empty()) break;
      wire.push_back(with_controller_.front());
      with_controller_.pop_front();
      if (!random.chance(loss)) send(wire.back().frame, true);
    }
    return wire;
  }

  void bus_off() {
    report(CAN_ERR_BUSOFF);
    drop();
    carrier_ = false;
  }
  void restart() {
    drop();
    report(CAN_ERR_RESTARTED);
    carrier_ = true;
  }
  [[nodiscard]] bool carrier() const { return carrier_; }

  /// Of one identifier, waiting or with the controller.
  [[nodiscard]] std::size_t most_of_one_identifier() const {
    std::vector<std::uint32_t> ids;
    for (const auto* part : {&queue_, &with_controller_}) {
      for (const OnWire& each : *part) ids.push_back(each.frame.id);
    }
    std::ranges::sort(ids);
    std::size_t most = 0;
    for (const std::uint32_t id : ids)
      most = std::max(most, static_cast<std::size_t>(std::ranges::count(ids, id)));
    return most;
  }

  /// Takes what was sent in a tick.
  void take(int number) {
    WireFrame wire;
    while (true) {
      const ssize_t bytes = ::recv(descriptor_, wire.data(), wire.size(), MSG_DONTWAIT);
      if (bytes <= 0) return;
      CanFrame frame;
      EXPECT_TRUE(from_wire(std::span<const std::byte>(wire).first(static_cast<std::size_t>(bytes)), frame));
      if (carrier_) queue_.push_back({frame, number});
    }
  }

 private:
  void send(const CanFrame& frame, bool echo) const {
    WireFrame wire;
    const std::size_t bytes = to_wire(frame, wire);
    if (echo) mark_echo(wire);
    EXPECT_EQ(::send(descriptor_, wire.data(), bytes, MSG_DONTWAIT), static_cast<ssize_t>(bytes));
  }
  void report(std::uint32_t kind) const {
    CanFrame frame;
    frame.error = true;
    frame.id = kind;
    frame.length = kClassicFrameBytes;
    send(frame, false);
  }
  void drop() {
    queue_.clear();
    with_controller_.clear();
  }

  int descriptor_;
  std::size_t mailboxes_;
  bool carrier_ = true;
  std::deque<OnWire> queue_;
  std::deque<OnWire> with_controller_;
};

constexpr std::uint32_t kCommands = 4;
constexpr int kTicks = 600;
constexpr int kQuietTicks = 100;  // at the end, without events

class EchoQueue : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override { ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0); }
  void TearDown() override {
    for (const int end : ends_) ::close(end);
  }
  int ends_[2] = {-1, -1};
};

/// Commands of four joints in every tick. At random times a bus-off, a restart some ticks later, a reset of
/// the fault before or after it; also a bus that others fill, and lost echoes.
TEST_P(EchoQueue, BusOffAndRestartNeitherSilenceAnIdentifierNorLeaveOldCommands) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomValues random(seed);
    FrameSocket bus(ends_[0], Echo::marked);
    Interface interface(ends_[1], GetParam());
    std::vector<int> last_on_wire(kCommands, 0);
    for (int tick = 0; tick < kTicks; ++tick) {
      const bool quiet = tick >= kTicks - kQuietTicks;
      std::array<CanFrame, kCommands> commands;
      for (std::uint32_t i = 0; i < kCommands; ++i) commands[i] = classic_frame(1 + i, 8);
      static_cast<void>(bus.send(commands));
      interface.take(tick);
      if (!quiet && random.chance(0.02) && interface.carrier()) interface.bus_off();
      if ((quiet || random.chance(0.1)) && !interface.carrier()) interface.restart();
      const bool blocked = !quiet && random.chance(0.3);
      const int most = blocked ? static_cast<int>(random.below(3)) : static_cast<int>(kCommands);
      for (const auto& sent : interface.send_some(most, quiet ? 0 : 0.01, random)) {
        EXPECT_LE(tick - sent.sent_tick, 8) << "an old command at tick " << tick;
        last_on_wire[sent.frame.id - 1] = tick;
      }
      EXPECT_LE(interface.most_of_one_identifier(), 1u) << "tick " << tick;
      std::array<CanFrame, kMaximumBatch> received;
      static_cast<void>(bus.receive(received));
      if (bus.health() == BusHealth::off && (quiet || random.chance(0.05))) bus.clear_bus_off();
      if (tick < kTicks - kQuietTicks + 10) continue;
      for (std::uint32_t i = 0; i < kCommands; ++i) {
        EXPECT_GE(last_on_wire[i], tick - 1) << "identifier " << i + 1 << " at tick " << tick;
      }
    }
    EXPECT_EQ(bus.health(), BusHealth::active);
    EXPECT_GT(bus.counters().bus_off, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Mailboxes, EchoQueue, ::testing::Values(1, 3, 16));

}  // namespace
}  // namespace stilt::hal::socketcan
