#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "firmware/configuration/configuration.h"

namespace stilt::gait_files {

/// Behind the error of a robot without shipped gaits.
inline constexpr std::string_view kOnlyShippedGaits =
    "; plans follow shipped gaits alone here, so set controller.reference = \"heuristic\"";

/// A configuration as configuration::load() reads it. Where controller.reference is hzd, with what plans
/// around the robot's shipped gaits need (gait_overrides), which `overrides` may change but for the step
/// time.
/// @return the error in sentences for the user
[[nodiscard]] std::expected<configuration::Configuration, std::string> load_around_gaits(
    const std::string& file, std::string_view robot, std::span<const configuration::Override> overrides,
    std::string_view preset = {});

}  // namespace stilt::gait_files
