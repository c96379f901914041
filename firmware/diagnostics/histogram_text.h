#pragma once

#include <string>
#include <string_view>

#include "firmware/diagnostics/histogram.h"

namespace stilt::diagnostics {

/// A histogram for people: one line of percentiles, then one line a bin that holds something, with a bar as
/// long as its share. Allocates: for ordinary threads, on a copy.
[[nodiscard]] std::string to_text(std::string_view name, const Histogram& histogram);

}  // namespace stilt::diagnostics
