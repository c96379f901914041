#include "firmware/configuration/gaits/gait_overrides.h"

#include <cmath>

#include "firmware/configuration/schema.h"

namespace stilt::gait_files {
namespace {

constexpr double kTerminalWeight = 10.0;
constexpr double kFootPosition_1_m2 = 15.0, kFootVelocity_s2_m2 = 6.0;  // the gait's joints place it, too
constexpr double kSameStep_s = 1e-3;

}  // namespace

std::vector<configuration::Override> gait_overrides(const gait::GaitLibrary& library,
                                                    const std::string& where) {
  const auto setting = [&where](const char* key, double value) {
    return configuration::Override{std::string(key) + "=" + configuration::number_text(value), where};
  };
  return {setting("cost.terminal", kTerminalWeight),
          {"cost.terminal_feet=false", where},
          setting("cost.foot_position", kFootPosition_1_m2),
          setting("cost.foot_velocity", kFootVelocity_s2_m2),
          setting("gait.single_support_s", library.step_time_s()),
          setting("gait.double_support_s", 0.0)};
}

std::optional<std::string> other_step_time(const gait::GaitLibrary& library,
                                           const configuration::Configuration& configuration) {
  const double asked_s = configuration.gait.single_support_s;
  if (std::abs(asked_s - library.step_time_s()) <= kSameStep_s) return std::nullopt;
  const std::string asked = configuration::number_text(asked_s);
  return "gait.single_support_s = " + asked + " must be the step time of the gaits that plans follow, " +
         configuration::number_text(1e-4 * std::round(1e4 * library.step_time_s())) +
         "; stilt gait library --step-time " + asked + " makes others, for stilt sim --gaits";
}

}  // namespace stilt::gait_files
