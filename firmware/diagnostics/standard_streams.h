#pragma once

/// The streams that a program starts with. Ordinary threads.
namespace stilt::diagnostics {

/// Whether everything that was printed on standard output has gone out; the last thing in main.
[[nodiscard]] bool all_printed();
inline constexpr const char* kNotPrinted =
    "standard output cannot be written, so what was printed is not complete";

}  // namespace stilt::diagnostics
