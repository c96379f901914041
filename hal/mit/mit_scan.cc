#include "hal/mit/mit_scan.h"

#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_driver.h"

namespace stilt::hal::mit {
namespace {

constexpr std::uint16_t kLastDamiao = 15;
constexpr std::uint16_t kLastOther = 32;

}  // namespace

std::vector<CanFrame> scan_frames(const MitDriver& driver) {
  std::vector<CanFrame> frames;
  const DamiaoRegisterMessage version{.number = static_cast<std::uint8_t>(DamiaoRegister::software_version)};
  CanFrame frame;
  if (driver.layout == ReplyLayout::damiao &&
      encode_register_request(driver, version, frame) == EncodeStatus::ok) {
    frames.push_back(frame);
  }
  frames.push_back(special_frame(driver, MitSpecial::leave));
  return frames;
}

bool take_scan(const MitDriver& driver, const CanFrame& frame, ScannedDriver& scanned) {
  if (frame.extended) return false;
  MitDriver sender = driver;
  sender.reply_id = static_cast<std::uint16_t>(frame.id);
  DamiaoRegisterMessage message;
  const bool answers_register = driver.layout == ReplyLayout::damiao &&
                                decode_register_answer(sender, frame, message) == DecodeStatus::ok &&
                                message.number == static_cast<std::uint8_t>(DamiaoRegister::software_version);
  if (answers_register) {
    scanned.version = message.bits;
  } else if (take_frame(sender, frame, scanned.reading) != DecodeStatus::ok) {
    return false;
  }
  scanned.answered = true;
  scanned.reply_id = frame.id;
  return true;
}

std::vector<MitDriver> scan_others(const MitDriver& driver) {
  const std::uint16_t last = driver.layout == ReplyLayout::damiao ? kLastDamiao : kLastOther;
  std::vector<MitDriver> others;
  for (std::uint16_t id = 1; id <= last; ++id) {
    if (id == driver.command_id) continue;
    others.push_back(driver);
    others.back().command_id = id;
    others.back().driver_id = static_cast<std::uint8_t>(id);
  }
  return others;
}

std::string version_text(const MitDriver& /*driver*/, std::uint32_t version) {
  return std::to_string(version);
}

}  // namespace stilt::hal::mit
