#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "firmware/configuration/edit.h"

namespace stilt::commissioning {

/// Values for a configuration file as indented lines, section.key = value.
[[nodiscard]] std::string values_text(std::span<const configuration::NewValue> values);

/// {"section.key": "value as TOML"}
[[nodiscard]] nlohmann::ordered_json values_json(std::span<const configuration::NewValue> values);

}  // namespace stilt::commissioning
