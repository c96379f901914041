#pragma once

#include <CLI/App.hpp>
#include <string>

namespace stilt::program {

/// What is wrong with a command line, in one sentence for the user: the command it belongs to, what is
/// missing or not known, what was probably meant, and which --help lists the rest. Start-up, ordinary
/// threads.
/// @param program  that threw the error in parse()
[[nodiscard]] std::string usage_text(const CLI::App& program, const CLI::ParseError& error);

}  // namespace stilt::program
