#include "hal/robot/driver_settings.h"

namespace stilt::hal {
namespace {

mit::MitSettingReader reader(const mit::MitDriver& driver, const bring_up::Options& options) {
  return {driver, options};
}
moteus::MoteusSettingReader reader(const moteus::MoteusDriver& driver, const bring_up::Options& options) {
  return {driver, options};
}
odrive::OdriveSettingReader reader(const odrive::OdriveDriver& driver, const bring_up::Options& options) {
  return {driver, options};
}
ak::AkSettingReader reader(const ak::AkDriver& driver, const bring_up::Options& options) {
  return {driver, options};
}

}  // namespace

SettingReader make_setting_reader(const JointDriver& driver, const bring_up::Options& options) {
  return visit_driver(driver, [&](const auto& any) -> SettingReader { return reader(any, options); });
}

}  // namespace stilt::hal
