#include "hal/odrive/odrive_settings.h"

#include <bit>
#include <cmath>

#include "hal/can/bytes.h"
#include "hal/driver/scanned_driver.h"
#include "hal/odrive/odrive_driver.h"
#include "hal/odrive/odrive_version.h"

namespace stilt::hal::odrive {
namespace {

constexpr double kHeartbeats_hz = 100, kTorques_hz = 200;        // as documented
constexpr double kLeastShare = 0.5, kLeastEstimatesShare = 0.8;  // as at bring-up

ReadSetting rate_setting(const char* name, const char* wanted, int count, double listened_s, double wanted_hz,
                         double least_share = kLeastShare) {
  const double rate_hz = count / listened_s;
  const std::string is = count == 0 ? "silent" : short_number(std::round(1000 / rate_hz));
  return {name, is, wanted, rate_hz >= least_share * wanted_hz};
}

ReadSetting version_setting(const std::string& of, std::uint32_t is, std::uint32_t wanted) {
  return {of + " version", is == 0 ? "" : dotted_bytes(is),
          dotted_bytes(wanted) + ", odrive_" + of + "_version; or that key and all endpoints must be its own",
          is == wanted};
}

}  // namespace

std::uint16_t OdriveSettingReader::endpoint() const {
  return asked_ == 0 ? driver_.endpoints.torque_mode_limit : driver_.endpoints.velocity_limit;
}

bool OdriveSettingReader::right_version() const {
  return version_ && firmware_number(*version_) == driver_.endpoints.firmware_version &&
         hardware_number(*version_) == driver_.endpoints.hardware_version;
}

std::optional<CanFrame> OdriveSettingReader::next(bool /*lost*/, bool give_up) {
  if (!driver_.endpoints.any()) return std::nullopt;
  CanFrame frame;
  if (!version_ && !give_up) {
    if (encode_request(driver_.node, OdriveCommand::version, frame) != EncodeStatus::ok) return std::nullopt;
    return frame;
  }
  if (!right_version()) return std::nullopt;
  if (give_up) ++asked_;
  while (asked_ < bits_.size() && endpoint() == 0) ++asked_;
  if (asked_ >= bits_.size()) return std::nullopt;
  const OdriveParameter question{false, endpoint(), 0, 4};
  if (encode_parameter_request(driver_.node, question, frame) != EncodeStatus::ok) return std::nullopt;
  return frame;
}

bool OdriveSettingReader::take(const CanFrame& frame) {
  OdriveVersion version;
  if (!version_ && decode(driver_.node, frame, version) == DecodeStatus::ok) {
    version_ = version;
    return true;
  }
  OdriveParameter answer;
  if (asked_ >= bits_.size() || decode_parameter_answer(driver_.node, frame, answer) != DecodeStatus::ok ||
      answer.endpoint != endpoint() || answer.value_bytes == 0) {
    return false;
  }
  bits_[asked_++] = answer.bits;
  return true;
}

void OdriveSettingReader::listen(const CanFrame& frame) {
  OdriveEstimates estimates;
  OdriveHeartbeat heartbeat;
  if (decode(driver_.node, frame, estimates) == DecodeStatus::ok) ++estimates_;
  if (decode(driver_.node, frame, heartbeat) == DecodeStatus::ok) ++heartbeats_;
  if (is_torques(driver_.node, frame)) ++torques_;
}

std::vector<ReadSetting> OdriveSettingReader::settings(double listened_s) const {
  std::vector<ReadSetting> all;
  if (driver_.endpoints.any()) {
    all.push_back(version_setting("firmware", version_ ? firmware_number(*version_) : 0,
                                  driver_.endpoints.firmware_version));
    all.push_back(version_setting("hardware", version_ ? hardware_number(*version_) : 0,
                                  driver_.endpoints.hardware_version));
  }
  if (right_version() && driver_.endpoints.torque_mode_limit != 0) {
    ReadSetting& limit =
        all.emplace_back("axis0.controller.config.enable_torque_mode_vel_limit", "", "false");
    if (bits_[0]) limit.is = (*bits_[0] & 0xff) == 0 ? "false" : "true";
    limit.right = limit.is == "false";
  }
  if (right_version() && driver_.endpoints.velocity_limit != 0) {
    const double wanted_rev_s = speed_rad_s_ / kRadiansPerRevolution;
    ReadSetting& limit = all.emplace_back("axis0.controller.config.vel_limit", "",
                                          "at least " + short_number(wanted_rev_s) + " or inf");
    if (bits_[1]) {
      const double value_rev_s = static_cast<double>(std::bit_cast<float>(*bits_[1]));
      limit.is = short_number(value_rev_s);
      limit.right = value_rev_s >= wanted_rev_s;
    }
  }
  all.push_back(rate_setting("axis0.config.can.encoder_msg_rate_ms", "1", estimates_, listened_s,
                             kOdriveEstimates_hz, kLeastEstimatesShare));
  all.push_back(
      rate_setting("axis0.config.can.heartbeat_msg_rate_ms", "10", heartbeats_, listened_s, kHeartbeats_hz));
  all.push_back(rate_setting("axis0.config.can.torques_msg_rate_ms", "5", torques_, listened_s, kTorques_hz));
  return all;
}

}  // namespace stilt::hal::odrive
