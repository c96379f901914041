#include "hal/odrive/odrive_scan.h"

#include "hal/odrive/odrive_driver.h"
#include "hal/odrive/odrive_version.h"

namespace stilt::hal::odrive {

std::vector<CanFrame> scan_frames(const OdriveDriver& driver) {
  std::vector<CanFrame> frames;
  for (const OdriveCommand what : {OdriveCommand::version, OdriveCommand::encoder_estimates,
                                   OdriveCommand::temperature, OdriveCommand::supply}) {
    CanFrame frame;
    if (encode_request(driver.node, what, frame) == EncodeStatus::ok) frames.push_back(frame);
  }
  return frames;
}

bool take_scan(const OdriveDriver& driver, const CanFrame& frame, ScannedDriver& scanned) {
  OdriveVersion version;
  OdriveHeartbeat heartbeat;
  OdriveEstimates estimates;
  const bool says_version = decode(driver.node, frame, version) == DecodeStatus::ok;
  const bool says_state = decode(driver.node, frame, heartbeat) == DecodeStatus::ok;
  const bool known = says_version || says_state || decode(driver.node, frame, estimates) == DecodeStatus::ok;
  if (take_frame(driver, frame, scanned.reading) != DecodeStatus::ok) return false;
  if (says_state) {  // bring-up switched its watchdog on, and nothing has fed it since the session
    scanned.watchdog_ended = heartbeat.errors == kOdriveWatchdogExpired &&
                             heartbeat.state == static_cast<std::uint8_t>(OdriveState::idle);
    if (scanned.watchdog_ended)
      scanned.reading.set_state(DriverState::idle, DriverFault::none, heartbeat.errors);
  }
  if (says_version) scanned.version = firmware_number(version);
  scanned.answered = scanned.answered || known;
  return true;
}

std::vector<OdriveDriver> scan_others(const OdriveDriver& driver) {
  std::vector<OdriveDriver> others;
  for (std::uint8_t node = 0; node < kOdriveMaximumNode; ++node) {  // the last is for all
    if (node == driver.node) continue;
    others.push_back(driver);
    others.back().node = node;
  }
  return others;
}

std::string version_text(const OdriveDriver& /*driver*/, std::uint32_t version) {
  return dotted_bytes(version);
}

}  // namespace stilt::hal::odrive
