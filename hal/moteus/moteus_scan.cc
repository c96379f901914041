#include "hal/moteus/moteus_scan.h"

#include "hal/moteus/moteus_driver.h"

namespace stilt::hal::moteus {

std::vector<CanFrame> scan_frames(const MoteusDriver& driver) {
  std::vector<CanFrame> frames;
  for (const MoteusQuery query : {MoteusQuery::identity, MoteusQuery::state_and_motor}) {
    CanFrame frame;
    if (encode_query(driver, query, frame) == EncodeStatus::ok) frames.push_back(frame);
  }
  return frames;
}

bool take_scan(const MoteusDriver& driver, const CanFrame& frame, ScannedDriver& scanned) {
  MoteusReply reply;
  if (decode_reply(driver, frame, reply) != DecodeStatus::ok) return false;
  scanned.answered = true;
  if (reply.has_firmware_version) scanned.version = reply.firmware_version;
  static_cast<void>(take_frame(driver, frame, scanned.reading));  // it decoded above
  return true;
}

std::vector<MoteusDriver> scan_others(const MoteusDriver& driver) {
  std::vector<MoteusDriver> others;
  for (std::uint8_t id = 1; id <= kMoteusMaximumId; ++id) {
    if (id == driver.id) continue;
    others.push_back(driver);
    others.back().id = id;
    others.back().extra_encoder = -1;
  }
  return others;
}

std::string version_text(const MoteusDriver& /*driver*/, std::uint32_t version) {
  return dotted_bytes(version);
}

}  // namespace stilt::hal::moteus
