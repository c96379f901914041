#pragma once

#include <variant>
#include <vector>

#include "hal/ak/ak_settings.h"
#include "hal/mit/mit_settings.h"
#include "hal/moteus/moteus_settings.h"
#include "hal/odrive/odrive_settings.h"
#include "hal/robot/joint_driver.h"

/// Reads back the settings of a driver, all of them: bring-up ends at the first that is wrong. Start-up only.
namespace stilt::hal {

using SettingReader = std::variant<mit::MitSettingReader, moteus::MoteusSettingReader,
                                   odrive::OdriveSettingReader, ak::AkSettingReader>;

/// @param options  travel and speed of the joint at the driver's shaft
[[nodiscard]] SettingReader make_setting_reader(const JointDriver& driver, const bring_up::Options& options);

/// Keys of the configuration by which bring-up refuses a driver that has no watchdog, or one whose place is
/// not known. Empty: a missing watchdog is accepted, or the driver has one.
[[nodiscard]] std::vector<ReadSetting> watchdog_keys(const JointDriver& driver,
                                                     const bring_up::Options& options);

}  // namespace stilt::hal
