#include "hal/ak/ak_settings.h"

#include <cmath>

namespace stilt::hal::ak {
namespace {

constexpr double kLeastShare = 0.8;  // as at bring-up

ReadSetting rate_setting(const char* name, int count, double listened_s, double wanted_hz) {
  const double rate_hz = count / listened_s;
  return {name, count == 0 ? "silent" : short_number(std::round(rate_hz)), short_number(wanted_hz),
          rate_hz >= kLeastShare * wanted_hz};
}

}  // namespace

void AkSettingReader::listen(const CanFrame& frame) {
  AkStatus status;
  double position_rad = 0;
  if (decode_status(driver_, frame, status) == DecodeStatus::ok) ++statuses_;
  if (decode_position(driver_, frame, position_rad) == DecodeStatus::ok) ++positions_;
}

std::vector<ReadSetting> AkSettingReader::settings(double listened_s) const {
  std::vector<ReadSetting> all{
      rate_setting("CAN feedback rate, Hz,", statuses_, listened_s, driver_.status_rate_hz)};
  if (driver_.position_frames)
    all.push_back(
        rate_setting("rate of position frames 0x2A, Hz,", positions_, listened_s, driver_.status_rate_hz));
  return all;
}

}  // namespace stilt::hal::ak
