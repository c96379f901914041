#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace stilt::program {

/// Reads a command line. An option with an empty value is refused, as `--config ''` and `--config=` are: the
/// program does not take a default in its place. A number that is NaN is refused. Start-up, ordinary threads.
/// @param words  those after the program's name, in their order
/// @throws CLI::ParseError, as App::parse() does
void parse(CLI::App& program, std::vector<std::string> words);

/// What is wrong with a command line, in one sentence for the user. It holds the command it belongs to, what
/// is missing or not known, what was probably meant, and which --help lists the rest. Start-up, ordinary
/// threads.
/// @param program  that threw the error in parse()
[[nodiscard]] std::string usage_text(const CLI::App& program, const CLI::ParseError& error);

}  // namespace stilt::program
