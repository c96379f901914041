#include "hal/mit/damiao_registers.h"

#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::mit {
namespace {

constexpr std::uint8_t kRead = 0x33;
constexpr std::uint8_t kWrite = 0x55;

EncodeStatus encode(std::uint32_t frame_id, std::uint16_t driver_id, const DamiaoRegisterMessage& message,
                    CanFrame& frame) noexcept {
  if (frame_id > kMaximumStandardId || driver_id > kMaximumStandardId) return EncodeStatus::invalid;
  frame = classic_frame(frame_id, 8);
  store_little(std::span(frame.data).first(2), driver_id);
  frame.data[2] = message.write ? kWrite : kRead;
  frame.data[3] = message.number;
  store_little(std::span(frame.data).subspan(4, 4), message.bits);
  return EncodeStatus::ok;
}

DecodeStatus decode(std::uint32_t frame_id, std::uint16_t driver_id, const CanFrame& frame,
                    DamiaoRegisterMessage& message) noexcept {
  if (frame.id != frame_id || frame.extended || frame.remote || frame.error || frame.fd)
    return DecodeStatus::not_addressed;
  if (frame.length != 8) return DecodeStatus::wrong_length;
  if (load_little(std::span(frame.data).first(2)) != driver_id) return DecodeStatus::not_addressed;
  if (frame.data[2] != kRead && frame.data[2] != kWrite) return DecodeStatus::not_addressed;
  message.write = frame.data[2] == kWrite;
  message.number = frame.data[3];
  message.bits = static_cast<std::uint32_t>(load_little(std::span(frame.data).subspan(4, 4)));
  return DecodeStatus::ok;
}

}  // namespace

EncodeStatus encode_register_request(const MitDriver& driver, const DamiaoRegisterMessage& message,
                                     CanFrame& frame) noexcept {
  return encode(kDamiaoRegisterId, driver.command_id, message, frame);
}

DecodeStatus decode_register_answer(const MitDriver& driver, const CanFrame& frame,
                                    DamiaoRegisterMessage& message) noexcept {
  return decode(driver.reply_id, driver.command_id, frame, message);
}

DecodeStatus decode_register_request(const MitDriver& driver, const CanFrame& frame,
                                     DamiaoRegisterMessage& message) noexcept {
  return decode(kDamiaoRegisterId, driver.command_id, frame, message);
}

EncodeStatus encode_register_answer(const MitDriver& driver, const DamiaoRegisterMessage& message,
                                    CanFrame& frame) noexcept {
  return encode(driver.reply_id, driver.command_id, message, frame);
}

}  // namespace stilt::hal::mit
