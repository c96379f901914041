#include "firmware/program/examples.h"

#include <string>

namespace stilt::program {
namespace {

/// Examples that begin with these words, each a line.
std::string examples_of(const std::string& words, std::span<const char* const> examples) {
  std::string text;
  for (const std::string example : examples) {
    if (example == words || example.starts_with(words + ' ')) text += "  " + example + '\n';
  }
  return text;
}

void add_to(CLI::App& command, const std::string& words, std::span<const char* const> examples) {
  const std::string text = examples_of(words, examples);
  const std::string after = command.get_footer();
  if (!text.empty()) command.footer("Examples:\n" + text + after);
  for (CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; })) {
    add_to(*inner, words + ' ' + inner->get_name(), examples);
  }
}

}  // namespace

void add_examples(CLI::App& program, std::span<const char* const> examples) {
  add_to(program, program.get_name(), examples);
}

}  // namespace stilt::program
