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

// Our end of a bus against what a CAN interface of the kernel does with frames. They wait in its queue, a few
// are with the controller, each that has left comes back as an echo. Bus-off and restart drop both without an
// echo (drivers/net/can/dev: can_bus_off, can_restart, can_flush_echo_skb), and a queue without carrier takes
// frames and frees them.
namespace stilt::hal::socketcan {
namespace {

using stilt::hal::testing::RandomValues;

/// Marked frames are the kernel's echoes.
int receive_with_echoes(int descriptor, mmsghdr* headers, unsigned count, int flags, timespec* timeout) {
  const int messages = ::recvmmsg(descriptor, headers, count, flags, timeout);
  for (int i = 0; i < messages; ++i) {
    const iovec& part = *headers[i].msg_hdr.msg_iov;
    if (marked_echo({static_cast<const std::byte*>(part.iov_base), headers[i].msg_len}))
      headers[i].msg_hdr.msg_flags |= MSG_CONFIRM;
  }
  return messages;
}

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

constexpr int kTicks = 600;
constexpr int kMostBlocked = 5;                         // ticks in a row, shorter than an echo is waited for
constexpr int kLongestLoss = 20, kBetweenLosses = 100;  // ticks, of all echoes
constexpr int kQuietTicks = 100;                        // at the end, without events

struct Case {
  std::size_t mailboxes;
  std::uint32_t commands;  ///< in every tick
};

class EchoQueue : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override { ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0); }
  void TearDown() override {
    for (const int end : ends_) ::close(end);
  }
  int ends_[2] = {-1, -1};
};

/// At random times: a bus-off, a restart some ticks later, a reset of the fault before or after it.
/// Besides: a bus that others fill, single lost echoes, and some ticks without any.
TEST_P(EchoQueue, BusOffAndRestartNeitherSilenceAnIdentifierNorLeaveOldCommands) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomValues random(seed);
    FrameSocket bus(ends_[0], Echo::kernel, {.receive_many = receive_with_echoes});
    const auto [mailboxes, count] = GetParam();
    Interface interface(ends_[1], mailboxes);
    std::vector<int> last_on_wire(count, 0);
    int blocked_for = 0;
    int echoes_from = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
      const bool quiet = tick >= kTicks - kQuietTicks;
      std::vector<CanFrame> commands;
      for (std::uint32_t i = 0; i < count; ++i) commands.push_back(classic_frame(1 + i, 8));
      static_cast<void>(bus.send(commands));
      interface.take(tick);
      if (!quiet && random.chance(0.02) && interface.carrier()) interface.bus_off();
      if ((quiet || random.chance(0.1)) && !interface.carrier()) interface.restart();
      const bool blocked = !quiet && blocked_for < kMostBlocked && random.chance(0.3);
      blocked_for = blocked ? blocked_for + 1 : 0;
      const int most = blocked ? static_cast<int>(random.below(3)) : static_cast<int>(count);
      if (!quiet && tick >= echoes_from + kBetweenLosses && random.chance(0.02))
        echoes_from = tick + 1 + static_cast<int>(random.below(kLongestLoss));
      const double loss = quiet ? 0 : tick < echoes_from ? 1 : 0.01;
      for (const auto& sent : interface.send_some(most, loss, random)) {
        EXPECT_LE(tick - sent.sent_tick, 8) << "an old command at tick " << tick;
        last_on_wire[sent.frame.id - 1] = tick;
      }
      EXPECT_LE(interface.most_of_one_identifier(), 1u) << "tick " << tick;
      std::array<CanFrame, kMaximumBatch> received;
      static_cast<void>(bus.receive(received));
      if (bus.health() == BusHealth::off && (quiet || random.chance(0.05))) bus.clear_bus_off();
      if (tick < kTicks - kQuietTicks + 30) continue;
      for (std::uint32_t i = 0; i < count; ++i) {
        EXPECT_GE(last_on_wire[i], tick - 1) << "identifier " << i + 1 << " at tick " << tick;
      }
    }
    EXPECT_EQ(bus.health(), BusHealth::active);
    EXPECT_GT(bus.counters().bus_off, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Mailboxes, EchoQueue,
                         ::testing::Values(Case{1, 4}, Case{3, 4}, Case{16, 4}, Case{3, 2}, Case{16, 2},
                                           Case{1, 1}, Case{16, 1}));

}  // namespace
}  // namespace stilt::hal::socketcan
