#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/can/frame_bus.h"

namespace stilt::hal::socketcan {

/// The real I/O code over a pair of Unix SOCK_SEQPACKET sockets, which frames like CAN_RAW.
class FrameSocketTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_), 0); }
  void TearDown() override {
    close_end(0);
    close_end(1);
  }
  void close_end(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  int ends_[2] = {-1, -1};
};

inline std::vector<CanFrame> receive_all(FrameBus& bus) {
  std::vector<CanFrame> all;
  std::array<CanFrame, kMaximumBatch> frames;
  while (true) {
    const ReceiveResult result = bus.receive(frames);
    all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(result.received));
    if (result.status != BusStatus::more) return all;
  }
}

inline CanFrame error_frame(std::uint32_t classes, std::uint8_t controller_detail = 0) {
  CanFrame frame;
  frame.error = true;
  frame.id = classes;
  frame.length = 8;
  frame.data[1] = controller_detail;
  return frame;
}

}  // namespace stilt::hal::socketcan
