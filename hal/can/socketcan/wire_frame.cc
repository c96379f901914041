#include "hal/can/socketcan/wire_frame.h"

#include <algorithm>
#include <cstring>

namespace stilt::hal::socketcan {
namespace {

canid_t identifier_of(const CanFrame& frame) noexcept {
  canid_t id = frame.id;
  if (frame.extended) id |= CAN_EFF_FLAG;
  if (frame.remote) id |= CAN_RTR_FLAG;
  if (frame.error) id |= CAN_ERR_FLAG;
  return id;
}

void take_identifier(canid_t id, CanFrame& frame) noexcept {
  frame.extended = (id & CAN_EFF_FLAG) != 0;
  frame.remote = (id & CAN_RTR_FLAG) != 0;
  frame.error = (id & CAN_ERR_FLAG) != 0;
  frame.id = id & CAN_EFF_MASK;
}

}  // namespace

std::size_t to_wire(const CanFrame& frame, WireFrame& wire) noexcept {
  if (!well_formed(frame)) return 0;
  wire.fill(std::byte{0});
  if (!frame.fd) {
    can_frame classic{};
    classic.can_id = identifier_of(frame);
    classic.len = frame.length;
    std::copy_n(frame.data.begin(), frame.length, classic.data);
    std::memcpy(wire.data(), &classic, sizeof classic);
    return sizeof classic;
  }
  canfd_frame flexible{};
  flexible.can_id = identifier_of(frame);
  flexible.len = frame.length;
  flexible.flags = frame.bit_rate_switch ? CANFD_BRS : 0;
  std::copy_n(frame.data.begin(), frame.length, flexible.data);
  std::memcpy(wire.data(), &flexible, sizeof flexible);
  return sizeof flexible;
}

bool from_wire(std::span<const std::byte> wire, CanFrame& frame) noexcept {
  CanFrame read;
  if (wire.size() == kClassicWireBytes) {
    can_frame classic{};
    std::memcpy(&classic, wire.data(), sizeof classic);
    take_identifier(classic.can_id, read);
    read.length = classic.len;
    std::copy_n(classic.data, kClassicFrameBytes, read.data.begin());
  } else if (wire.size() == kFdWireBytes) {
    canfd_frame flexible{};
    std::memcpy(&flexible, wire.data(), sizeof flexible);
    take_identifier(flexible.can_id, read);
    read.fd = true;
    read.bit_rate_switch = (flexible.flags & CANFD_BRS) != 0;
    read.length = flexible.len;
    std::copy_n(flexible.data, kMaximumFrameBytes, read.data.begin());
  } else {
    return false;
  }
  if (!well_formed(read)) return false;
  std::fill(read.data.begin() + read.length, read.data.end(), std::uint8_t{0});
  frame = read;
  return true;
}

}  // namespace stilt::hal::socketcan
