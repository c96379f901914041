#include "firmware/configuration/live.h"

#include <algorithm>
#include <string_view>

namespace stilt::configuration {
namespace {

constexpr double kFactor = 4.0;
constexpr double kLowerHip_m = 0.08;
constexpr double kHigherHip_m = 0.02;
constexpr std::string_view kHeight = "base_height_m";

bool is_live(const Entry& entry) {
  if (!std::holds_alternative<RealField>(entry.field)) return false;
  if (entry.section == "cost") return true;
  if (entry.section == "gait") return entry.key == "swing_height_m";
  if (entry.section == "reference") return entry.key == kHeight;
  return entry.section == "torque_law" && entry.key != "friction_velocity_rad_s" &&
         !entry.key.starts_with("feedback_");  // two ages in order
}

LiveTunable tunable(const Entry& entry, const Configuration& configuration) {
  const auto& field = std::get<RealField>(entry.field);
  const double value = field.get(configuration);
  const bool height = entry.key == kHeight;
  const double low = height ? value - kLowerHip_m : value / kFactor;
  const double high = height ? value + kHigherHip_m : value * kFactor;
  return {&entry, value, std::max(field.min, low), std::min(field.max, high)};
}

}  // namespace

std::vector<LiveTunable> live_tunables(const Configuration& configuration) {
  std::vector<LiveTunable> tunables;
  for (const Entry& entry : entries()) {
    if (is_live(entry)) tunables.push_back(tunable(entry, configuration));
  }
  return tunables;
}

Configuration with_live_values(const Configuration& configuration, std::span<const double> values) {
  Configuration changed = configuration;
  const std::vector<LiveTunable> tunables = live_tunables(configuration);
  for (std::size_t i = 0; i < std::min(values.size(), tunables.size()); ++i) {
    std::get<RealField>(tunables[i].entry->field).set(changed, values[i]);
  }
  return changed;
}

}  // namespace stilt::configuration
