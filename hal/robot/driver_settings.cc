#include "hal/robot/driver_settings.h"

#include <string>

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

std::vector<ReadSetting> keys(const moteus::MoteusDriver& /*driver*/) { return {}; }

std::vector<ReadSetting> accepted() {
  return {{"accept_missing_watchdog", "false", "true: it has no watchdog that can be read"}};
}
std::vector<ReadSetting> keys(const mit::MitDriver& driver) {
  return driver.layout == mit::ReplyLayout::damiao ? std::vector<ReadSetting>{} : accepted();
}
std::vector<ReadSetting> keys(const ak::AkDriver& /*driver*/) { return accepted(); }

ReadSetting endpoint(const std::string& parameter, std::uint16_t number) {
  return {"odrive_" + parameter + "_endpoint", std::to_string(number),
          "the id of axis0.config." + parameter +
              " in flat_endpoints.json of its firmware, or accept_missing_watchdog must be true",
          number != 0};
}
std::vector<ReadSetting> keys(const odrive::OdriveDriver& driver) {
  return {endpoint("watchdog_timeout", driver.endpoints.watchdog_timeout),
          endpoint("enable_watchdog", driver.endpoints.enable_watchdog)};
}

}  // namespace

std::vector<ReadSetting> watchdog_keys(const JointDriver& driver, const bring_up::Options& options) {
  if (options.accept_missing_watchdog) return {};
  return visit_driver(driver, [](const auto& any) { return keys(any); });
}

SettingReader make_setting_reader(const JointDriver& driver, const bring_up::Options& options) {
  return visit_driver(driver, [&](const auto& any) -> SettingReader { return reader(any, options); });
}

}  // namespace stilt::hal
