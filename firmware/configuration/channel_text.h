#pragma once

#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "hal/sensors/torso_sensor_table.h"

namespace stilt::configuration {

/// Reads which bits of which frame are a channel: value = scale raw + offset. "none" gives nothing. Words in
/// any order, each once, numbers decimal or 0x:
///
///   id N  [extended]  byte N  [bit N]  bits N  signed|unsigned|float  little|big  [scale X]  [offset X]
///   [invalid N]
///
/// The error says what is wrong. Start-up only.
[[nodiscard]] std::expected<std::optional<hal::ChannelRow>, std::string> parse_channel(
    std::string_view text, hal::BaseChannel channel);

/// The text of a channel whose value is factor * (that of `text`) + offset, its scale and offset last.
[[nodiscard]] std::string transformed_channel(std::string_view text, double factor, double offset);

}  // namespace stilt::configuration
