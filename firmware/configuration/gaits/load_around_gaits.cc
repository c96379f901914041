#include "firmware/configuration/gaits/load_around_gaits.h"

#include <memory>
#include <optional>
#include <vector>

#include "firmware/configuration/diagnostic.h"
#include "firmware/configuration/gaits/gait_overrides.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "mpc_core/gait/gait_library.h"

namespace stilt::gait_files {

std::expected<configuration::Configuration, std::string> load_around_gaits(
    const std::string& file, std::string_view robot, std::span<const configuration::Override> overrides,
    std::string_view preset) {
  configuration::Result result = configuration::load(file, robot, overrides, preset);
  if (result && result->controller.reference == configuration::ReferenceKind::hzd) {
    const auto library = std::make_unique<gait::GaitLibrary>();
    if (const auto loaded = load_shipped_library(result->hardware.robot, *library); !loaded) {
      return std::unexpected("controller.reference is hzd: " + loaded.error() +
                             std::string(kOnlyShippedGaits));
    }
    auto all = gait_overrides(*library, "controller.reference");
    all.insert(all.end(), overrides.begin(), overrides.end());
    result = configuration::load(file, robot, all, preset);
    const auto wrong = result ? other_step_time(*library, *result) : std::nullopt;
    if (wrong) return std::unexpected("controller.reference is hzd: " + *wrong);
  }
  if (!result) return std::unexpected(configuration::to_string(result.error()));
  return std::move(*result);
}

}  // namespace stilt::gait_files
