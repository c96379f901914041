#pragma once

#include <string_view>

namespace stilt::version {

/// The commit that the program was built from: twelve hexadecimal digits or more, with "-dirty" when its
/// sources differed from it. "unknown" when they were in no git repository of their own. Looked up at every
/// build.
[[nodiscard]] std::string_view commit() noexcept;

}  // namespace stilt::version
