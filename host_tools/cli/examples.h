#pragma once

#include <CLI/App.hpp>

namespace stilt::cli {

/// Puts examples in front of the text after the options in --help of the program and of every command.
void add_examples(CLI::App& program);

}  // namespace stilt::cli
