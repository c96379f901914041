#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Numbers in what users type and read.
namespace stilt::simulation {

/// The finite number that fills the whole text, or nothing. Decimal point, no locale, no hexadecimal.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Shortest usual form, six significant digits: 0.8, 1e-05, 40.
[[nodiscard]] std::string number_text(double value);

}  // namespace stilt::simulation
