#include "firmware/program/option_checks.h"

#include <algorithm>
#include <span>
#include <string_view>

namespace stilt::program {
namespace {

bool is_one_of(std::string_view name, std::span<const std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

std::expected<void, std::string> check_options_before(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    for (const CLI::Option* option : app.get_options()) {
      if (option->count() == 0) continue;
      const CLI::Option* own = command->get_option_no_throw(option->get_name());
      if (own != nullptr && own->count() == 0) continue;
      return std::unexpected(
          option->get_name() + ": " +
          (own == nullptr ? "is no option of " + command->get_name() + "; leave it out"
                          : "is before " + command->get_name() + " and behind it; give all of it behind"));
    }
  }
  return {};
}

std::expected<void, std::string> check_options_of_reports(const CLI::App& app) {
  constexpr std::string_view kChoosing[] = {"--config", "--robot", "--preset", "--set", "--bus"};
  constexpr std::string_view kChecked[] = {"--start", "--torque-limit"};
  for (const std::string report : {"--print-config", "--check-config"}) {
    if (app.count(report) == 0) continue;
    for (const CLI::Option* option : app.get_options()) {
      const std::string name = option->get_name();
      const bool taken = name == report || is_one_of(name, kChoosing) ||
                         (report == "--check-config" && is_one_of(name, kChecked));
      if (option->count() > 0 && !taken) {
        return std::unexpected(std::string(name).append(": has no meaning with ").append(report) +
                               "; leave it out");
      }
    }
  }
  return {};
}

}  // namespace stilt::program
