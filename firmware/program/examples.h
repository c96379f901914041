#pragma once

#include <CLI/App.hpp>
#include <span>

namespace stilt::program {

/// Puts before the footer of the program's help, and of each command's, the examples that begin with its
/// words.
void add_examples(CLI::App& program, std::span<const char* const> examples);

}  // namespace stilt::program
