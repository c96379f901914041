#pragma once

#include <string_view>

namespace stilt::version {

/// The commit that the program was built from: twelve hexadecimal digits or more. Where its sources
/// differed from it, "-dirty." follows, and when the newest of them was written: "-dirty.20261128T064100Z".
/// "unknown-" and twelve digits of a hash of the sources when they were in no git repository of their own.
/// Looked up at every build.
[[nodiscard]] std::string_view commit() noexcept;

}  // namespace stilt::version
