#pragma once

#include <string>

namespace stilt::commissioning {

/// A sentence of at most 399 characters, as printf writes it. Allocates; not for real time.
[[gnu::format(printf, 1, 2)]] [[nodiscard]] std::string formatted(const char* format, ...);

}  // namespace stilt::commissioning
