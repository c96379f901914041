#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "hal/bring_up/bring_up.h"
#include "hal/driver/read_setting.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// Reads the limits of an ODrive whose endpoints are known, and counts how often it reports. Start-up only.
class OdriveSettingReader {
 public:
  /// @param options  speed of the joint at the driver's shaft
  OdriveSettingReader(const OdriveDriver& driver, const bring_up::Options& options)
      : driver_(driver), speed_rad_s_(options.maximum_speed_rad_s) {}

  /// As of mit::MitSettingReader. Its version first: endpoints of another are not asked.
  [[nodiscard]] std::optional<CanFrame> next(bool lost, bool give_up);
  [[nodiscard]] bool take(const CanFrame& frame);
  void listen(const CanFrame& frame);
  [[nodiscard]] std::vector<ReadSetting> settings(double listened_s) const;

 private:
  [[nodiscard]] std::uint16_t endpoint() const;
  [[nodiscard]] bool right_version() const;

  OdriveDriver driver_;
  double speed_rad_s_;
  std::optional<OdriveVersion> version_;
  std::array<std::optional<std::uint32_t>, 2> bits_;  ///< of torque-mode limit and velocity limit
  std::size_t asked_ = 0;
  int estimates_ = 0;
  int heartbeats_ = 0;
  int torques_ = 0;
};

}  // namespace stilt::hal::odrive
