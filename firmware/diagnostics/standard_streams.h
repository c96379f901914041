#pragma once

/// The three streams that a program starts with. Ordinary threads.
namespace stilt::diagnostics {

/// Puts /dev/null in the place of standard input, output and errors where they are closed; the first thing in
/// main. Else the next socket or file gets their number, and a bus gets the program's texts. To read or write
/// there fails, as on a closed one, so that lost output is still noticed.
/// @return  false: there is no /dev/null
[[nodiscard]] bool keep_standard_streams() noexcept;

/// Whether everything that was printed on standard output has gone out; the last thing in main.
[[nodiscard]] bool all_printed();
inline constexpr const char* kNotPrinted =
    "standard output cannot be written, so what was printed is not complete";

}  // namespace stilt::diagnostics
