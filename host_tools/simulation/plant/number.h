#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

/// Numbers in the text that users type and read.
namespace stilt::simulation {

/// The finite number that the whole text represents, or nothing. Decimal point, no locale, no hexadecimal.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Shortest usual form with six significant digits: 0.8, 1e-05, 40.
[[nodiscard]] std::string number_text(double value);

/// With the decimals that the number has, up to twelve, and at least `least`: 0.50, 0.501. For names of
/// files: different numbers that a user types have different texts.
[[nodiscard]] std::string decimals_text(double value, std::size_t least = 2);

}  // namespace stilt::simulation
