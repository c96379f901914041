#include "host_tools/recording/run/settings.h"

#include <algorithm>

#include "firmware/configuration/schema.h"

namespace stilt::record {

std::vector<log::Setting> settings_of(const configuration::Configuration& configuration) {
  std::vector<log::Setting> settings;
  for (const configuration::Entry& entry : configuration::entries()) {
    settings.push_back({entry.name(), configuration::value_text(entry, configuration)});
  }
  return settings;
}

std::vector<std::array<double, model::kJoints>> allowed_torque_Nm(
    const configuration::Configuration& configuration, const model::RobotConstants& robot) {
  std::vector<double> shares = {configuration.supervisor.torque_limit_share};
  if (configuration.robot.torque_limit_scale < shares[0])
    shares.push_back(configuration.robot.torque_limit_scale);
  std::vector<std::array<double, model::kJoints>> allowed_Nm;
  for (const double share : shares) {
    std::ranges::transform(robot.torque_limit_Nm, allowed_Nm.emplace_back().begin(),
                           [share](double limit_Nm) { return share * limit_Nm; });
  }
  return allowed_Nm;
}

}  // namespace stilt::record
