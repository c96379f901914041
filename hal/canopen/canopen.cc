#include "hal/canopen/canopen.h"

#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::canopen {
namespace {

constexpr std::uint8_t kSdoBytes = 8;
constexpr std::size_t kValueAt = 4;
// Command specifiers, the upper three bits of the first byte.
constexpr std::uint8_t kWriteRequest = 1, kReadRequest = 2;
constexpr std::uint8_t kReadAnswer = 2, kWriteAnswer = 3, kAbort = 4;
constexpr std::uint8_t kExpedited = 0x02, kSizeSaid = 0x01;

bool is_data(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && !frame.extended && !frame.remote && !frame.error && !frame.fd;
}

std::span<std::uint8_t> value_field(CanFrame& frame) noexcept {
  return std::span(frame.data).subspan(kValueAt, 4);
}

CanFrame sdo_frame(std::uint32_t id, std::uint8_t command, const Object& object,
                   std::uint32_t value) noexcept {
  CanFrame frame = classic_frame(id, kSdoBytes);
  frame.data[0] = command;
  store_little(std::span(frame.data).subspan(1, 2), object.index);
  frame.data[3] = object.subindex;
  store_little(value_field(frame), value);
  return frame;
}

/// With the number of bytes without data, if any is given.
std::uint8_t expedited(std::uint8_t specifier, std::uint8_t bytes) noexcept {
  return static_cast<std::uint8_t>(specifier << 5 | (4 - bytes) << 2 | kExpedited | kSizeSaid);
}

std::uint8_t said_bytes(std::uint8_t command) noexcept {
  return (command & kSizeSaid) == 0 ? 0 : static_cast<std::uint8_t>(4 - (command >> 2 & 3));
}

Object object_of(const CanFrame& frame) noexcept {
  return {static_cast<std::uint16_t>(load_little(frame.payload().subspan(1, 2))), frame.data[3]};
}

/// Without what lies beyond the object.
std::uint32_t value_of(const CanFrame& frame, std::uint8_t bytes) noexcept {
  const std::size_t count = bytes == 0 ? 4 : bytes;
  return static_cast<std::uint32_t>(load_little(frame.payload().subspan(kValueAt, count)));
}

}  // namespace

CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept {
  CanFrame frame = classic_frame(kNmtId, 2);
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = node;
  return frame;
}

CanFrame sync_frame() noexcept { return classic_frame(kSyncId, 0); }

CanFrame heartbeat_frame(std::uint8_t node, NmtState state) noexcept {
  CanFrame frame = classic_frame(heartbeat_id(node), 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

CanFrame sdo_read_frame(std::uint8_t node, const Object& object) noexcept {
  return sdo_frame(sdo_request_id(node), kReadRequest << 5, object, 0);
}

CanFrame sdo_write_frame(std::uint8_t node, const Object& object, std::uint32_t value,
                         std::uint8_t bytes) noexcept {
  return sdo_frame(sdo_request_id(node), expedited(kWriteRequest, bytes), object, value);
}

DecodeStatus decode_answer(std::uint8_t node, const CanFrame& frame, SdoAnswer& answer) noexcept {
  if (!is_data(frame, sdo_answer_id(node))) return DecodeStatus::not_addressed;
  if (frame.length != kSdoBytes) return DecodeStatus::wrong_length;
  const std::uint8_t command = frame.data[0];
  const std::uint8_t specifier = command >> 5;
  if (specifier == kReadAnswer && (command & kExpedited) != 0) {
    answer = {SdoAnswer::Kind::value, object_of(frame), value_of(frame, said_bytes(command))};
  } else if (specifier == kWriteAnswer) {
    answer = {SdoAnswer::Kind::written, object_of(frame), 0};
  } else if (specifier == kAbort) {
    answer = {SdoAnswer::Kind::aborted, object_of(frame), value_of(frame, 4)};
  } else {
    return DecodeStatus::malformed;
  }
  return DecodeStatus::ok;
}

std::optional<NmtState> decode_heartbeat(std::uint8_t node, const CanFrame& frame) noexcept {
  if (!is_data(frame, heartbeat_id(node)) || frame.length != 1) return std::nullopt;
  return static_cast<NmtState>(frame.data[0] & 0x7f);  // the highest bit toggles with node guarding
}

DecodeStatus decode_request(std::uint8_t node, const CanFrame& frame, SdoRequest& request) noexcept {
  if (!is_data(frame, sdo_request_id(node))) return DecodeStatus::not_addressed;
  if (frame.length != kSdoBytes) return DecodeStatus::wrong_length;
  const std::uint8_t command = frame.data[0];
  const std::uint8_t specifier = command >> 5;
  const bool write = specifier == kWriteRequest && (command & kExpedited) != 0;
  if (!write && specifier != kReadRequest) return DecodeStatus::malformed;
  const std::uint8_t bytes = write ? said_bytes(command) : 0;
  request = {write, object_of(frame), write ? value_of(frame, bytes) : 0, bytes};
  return DecodeStatus::ok;
}

CanFrame answer_frame(std::uint8_t node, const SdoAnswer& answer, std::uint8_t bytes) noexcept {
  const std::uint32_t id = sdo_answer_id(node);
  switch (answer.kind) {
    case SdoAnswer::Kind::value:
      return sdo_frame(id, expedited(kReadAnswer, bytes), answer.object, answer.value);
    case SdoAnswer::Kind::written:
      return sdo_frame(id, kWriteAnswer << 5, answer.object, 0);
    case SdoAnswer::Kind::aborted:
      break;
  }
  return sdo_frame(id, kAbort << 5, answer.object, answer.value);
}

}  // namespace stilt::hal::canopen
