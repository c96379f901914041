#pragma once

#include <optional>
#include <vector>

#include "hal/ak/ak_protocol.h"
#include "hal/bring_up/bring_up.h"
#include "hal/driver/read_setting.h"

namespace stilt::hal::ak {

/// Counts how often an AK of version 3 reports: there is nothing to ask it for. Start-up only.
class AkSettingReader {
 public:
  AkSettingReader(const AkDriver& driver, const bring_up::Options& /*options*/) : driver_(driver) {}

  /// As of mit::MitSettingReader.
  [[nodiscard]] std::optional<CanFrame> next(bool /*lost*/, bool /*give_up*/) { return std::nullopt; }
  [[nodiscard]] bool take(const CanFrame& /*frame*/) { return false; }
  void listen(const CanFrame& frame);
  [[nodiscard]] std::vector<ReadSetting> settings(double listened_s) const;

 private:
  AkDriver driver_;
  int statuses_ = 0;
  int positions_ = 0;
};

}  // namespace stilt::hal::ak
