#pragma once

#include <string_view>

#include "firmware/configuration/hardware.h"

namespace stilt::configuration {

/// As in the configuration: mit_damiao, moteus, ...
[[nodiscard]] std::string_view name(DriverProtocol protocol) noexcept;

}  // namespace stilt::configuration
