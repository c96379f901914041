#include "hal/can/socketcan/frame_socket.h"

#include <linux/can/error.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace stilt::hal::socketcan {
namespace {

constexpr std::size_t kEchoByte = offsetof(can_frame, __res0);
static_assert(kEchoByte == offsetof(canfd_frame, __res0));
constexpr std::byte kEchoMark{0x45};

}  // namespace

void mark_echo(std::span<std::byte> wire) noexcept { wire[kEchoByte] = kEchoMark; }

bool marked_echo(std::span<const std::byte> wire) noexcept {
  return wire.size() > kEchoByte && wire[kEchoByte] == kEchoMark;
}

void FrameSocket::reset(int descriptor) noexcept {
  descriptor_ = descriptor;
  gone_ = carrier_lost_ = false;
  overflow_total_ = 0;
  confirmations_.forget();
}

void FrameSocket::lose_connection() noexcept {
  if (gone_) return;
  gone_ = true;
  ++counters_.disconnections;
  confirmations_.forget();
}

BusStatus FrameSocket::failure(int error_number) noexcept {
  switch (error_number) {
    case ENOBUFS:
    case EAGAIN:
    case EINTR:
      return BusStatus::queue_full;
    case EMSGSIZE:
    case EINVAL:
      ++counters_.malformed;
      return BusStatus::malformed;  // FD on a classic interface, say
    default:
      lose_connection();
      return BusStatus::disconnected;
  }
}

/// Whether frame i has a predecessor with its identifier that has not been seen on the bus, in this batch or
/// before.
bool FrameSocket::must_wait(std::span<const CanFrame> frames, std::size_t i,
                            std::span<const std::uint8_t> taken) const noexcept {
  if (confirmations_.waiting(frames[i]) || !confirmations_.has_room(frames[i], taken.size())) return true;
  return std::any_of(taken.begin(), taken.end(),
                     [&](std::uint8_t j) { return Confirmations::same(frames[j], frames[i]); });
}

/// Puts what may be sent into the batch; `taken` are the indices of its frames. The frame that found no place
/// last time is the first one now. Else a queue that is always nearly full would silence the same joint.
std::size_t FrameSocket::collect(std::span<const CanFrame> frames,
                                 std::array<std::uint8_t, kMaximumBatch>& taken, BusStatus& status) noexcept {
  std::size_t count = 0;
  for (std::size_t place = 0; place < frames.size(); ++place) {
    const std::size_t i = (place + first_) % frames.size();
    if (echo_ != Echo::none && must_wait(frames, i, std::span(taken).first(count))) {
      ++counters_.withheld;
      // Frames of a controller that no node acknowledges wait, and so do those for a stopped process.
      const bool may_be_lost = echo_ == Echo::kernel && health_ != BusHealth::passive;
      if (confirmations_.refuse(frames[i], may_be_lost)) ++counters_.echoes_lost;
      status = BusStatus::unconfirmed;
      continue;
    }
    const std::size_t bytes = to_wire(frames[i], batch_.wire[count]);
    if (bytes == 0) {
      ++counters_.malformed;
      status = BusStatus::malformed;
      continue;
    }
    batch_.vectors[count] = {batch_.wire[count].data(), bytes};
    batch_.headers[count] = {};
    batch_.headers[count].msg_hdr.msg_iov = &batch_.vectors[count];
    batch_.headers[count].msg_hdr.msg_iovlen = 1;
    taken[count++] = static_cast<std::uint8_t>(i);
  }
  return count;
}

SendResult FrameSocket::send(std::span<const CanFrame> frames) noexcept {
  if (!connected()) return {0, BusStatus::disconnected};
  SendResult result;
  if (frames.size() > kMaximumBatch) {
    counters_.dropped_full += frames.size() - kMaximumBatch;
    frames = frames.first(kMaximumBatch);
    result.status = BusStatus::queue_full;
  }
  std::array<std::uint8_t, kMaximumBatch> taken{};
  const std::size_t count = collect(frames, taken, result.status);
  if (count == 0) return result;
  const int sent = calls_.send_many(descriptor_, batch_.headers.data(), static_cast<unsigned>(count),
                                    MSG_DONTWAIT | MSG_NOSIGNAL);
  result.sent = sent > 0 ? static_cast<std::size_t>(sent) : 0;
  counters_.sent += result.sent;
  for (std::size_t i = 0; i < result.sent && echo_ != Echo::none; ++i) {
    static_cast<void>(confirmations_.sent(frames[taken[i]]));  // collect kept to the capacity
  }
  if (result.sent < count) {
    // After a partial batch the kernel keeps the reason for the next call; a full queue is the one that
    // occurs.
    result.status = sent < 0 ? failure(errno) : BusStatus::queue_full;
    counters_.dropped_full += result.status == BusStatus::queue_full ? count - result.sent : 0;
  }
  if (frames.size() > 1) first_ = result.sent < count ? taken[result.sent] : 0;
  return result;
}

void FrameSocket::prepare_receive(std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    batch_.vectors[i] = {batch_.wire[i].data(), batch_.wire[i].size()};
    batch_.headers[i] = {};
    msghdr& header = batch_.headers[i].msg_hdr;
    header.msg_iov = &batch_.vectors[i];
    header.msg_iovlen = 1;
    header.msg_control = batch_.control[i].data();
    header.msg_controllen = batch_.control[i].size();
  }
}

ReceiveResult FrameSocket::receive(std::span<CanFrame> frames) noexcept {
  if (!connected()) return {0, BusStatus::disconnected};
  const std::size_t room = std::min(frames.size(), kMaximumBatch);
  if (room == 0) return {0, BusStatus::more};
  prepare_receive(room);
  const int messages = calls_.receive_many(descriptor_, batch_.headers.data(), static_cast<unsigned>(room),
                                           MSG_DONTWAIT, nullptr);
  if (messages < 0) {
    if (errno == EAGAIN || errno == EINTR || errno == ENOBUFS) return {0, BusStatus::ok};
    lose_connection();
    return {0, BusStatus::disconnected};
  }
  ReceiveResult result;
  for (std::size_t i = 0; i < static_cast<std::size_t>(messages); ++i) {
    if (batch_.headers[i].msg_len == 0) {  // end of a Unix connection; CAN has no empty messages
      lose_connection();
      break;
    }
    if (take(i, frames[result.received])) ++result.received;
  }
  counters_.received += result.received;
  if (gone_) {
    result.status = BusStatus::disconnected;
    return result;
  }
  result.status = static_cast<std::size_t>(messages) == room ? BusStatus::more : BusStatus::ok;
  return result;
}

bool FrameSocket::take(std::size_t index, CanFrame& frame) noexcept {
  msghdr& header = batch_.headers[index].msg_hdr;
  const std::size_t size = std::min<std::size_t>(batch_.headers[index].msg_len, batch_.wire[index].size());
  const auto wire = std::span<const std::byte>(batch_.wire[index]).first(size);
  take_control(header);
  CanFrame read;
  if ((header.msg_flags & MSG_TRUNC) != 0 || !from_wire(wire, read)) {
    ++counters_.malformed;
    return false;
  }
  const bool own = echo_ == Echo::kernel ? (header.msg_flags & MSG_CONFIRM) != 0
                                         : echo_ == Echo::marked && marked_echo(wire);
  if (own) {
    counters_.echoes_lost += confirmations_.confirm(read);
    ++counters_.confirmed;
    return false;
  }
  if (read.error) {
    take_error(read);
    return false;
  }
  frame = read;
  return true;
}

/// How many frames the kernel dropped for us since the socket was opened.
void FrameSocket::take_control(msghdr& header) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t total = 0;
    std::memcpy(&total, CMSG_DATA(part), sizeof total);
    const std::uint32_t lost = total - overflow_total_;
    overflow_total_ = total;
    counters_.dropped_received += lost;
    if (lost > 0) confirmations_.forget();  // an echo may be among them
  }
}

void FrameSocket::take_error(const CanFrame& frame) noexcept {
  ++counters_.error_frames;
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    ++counters_.bus_off;
    health_ = BusHealth::off;
    carrier_lost_ = true;
    confirmations_.forget();  // the controller has dropped its queue
  }
  if ((frame.id & CAN_ERR_RESTARTED) != 0) {
    carrier_lost_ = false;
    confirmations_.forget();  // a restart drops without echo what came since
  }
  if (health_ == BusHealth::off) return;  // an automatic restart does not undo it
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    const std::uint8_t detail = frame.data[1];
    if ((detail & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      health_ = BusHealth::passive;
    } else if ((detail & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      health_ = BusHealth::warning;
    } else if ((detail & CAN_ERR_CRTL_ACTIVE) != 0) {
      health_ = BusHealth::active;
    }
  }
}

}  // namespace stilt::hal::socketcan
