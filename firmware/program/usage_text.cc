#include "firmware/program/usage_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/configuration/schema.h"

namespace stilt::program {
namespace {

using Names = std::vector<std::string>;

/// The command that was being read, and the words that led there: "stilt gait show".
struct Command {
  const CLI::App* app;
  std::string words;
};

Command command_of(const CLI::App& program) {
  Command command{&program, program.get_name()};
  for (auto inner = command.app->get_subcommands(); !inner.empty(); inner = command.app->get_subcommands()) {
    command.app = inner.back();
    command.words += ' ' + command.app->get_name();
  }
  return command;
}

Names commands_of(const CLI::App& app) {
  Names names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

Names options_of(const CLI::App& app) {
  Names names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool contains(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::string listed(const Names& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* separator = i == 0 ? "" : i + 1 == names.size() ? " or " : ", ";
    text += separator + names[i];
  }
  return text;
}

/// "; did you mean --speed?", or nothing.
std::string suggestion(const std::string& word, const Names& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string_view likely = configuration::nearest(word, views);
  return likely.empty() ? "" : "; did you mean " + std::string(likely) + '?';
}

std::string missing_command(const Command& command) {
  const Names names = commands_of(*command.app);
  const Names words = command.app->remaining();
  if (words.empty()) return "a command is expected: " + listed(names);
  const std::string likely = suggestion(words.front(), names);
  return words.front() + " is no command" + (likely.empty() ? "; there are " + listed(names) : likely);
}

std::string unexpected_word(const CLI::App& program, const Command& command) {
  const Names words = command.app->remaining();
  if (command.app != &program && contains(commands_of(program), words.front())) {
    return words.front() + " is a second command; give one at a time";
  }
  const auto option =
      std::ranges::find_if(words, [](const std::string& word) { return word.starts_with("-"); });
  if (option == words.end()) return words.front() + " is not expected";
  return *option + " is no option" + suggestion(*option, options_of(*command.app));
}

[[noreturn]] void refuse_empty(const std::string& option) {
  throw CLI::ValidationError(option, "its value is empty; give one, or leave " + option + " out");
}

/// CLI11 takes the next word where nothing stands behind the =.
void refuse_empty_behind_sign(const Names& words) {
  for (const std::string& word : words) {
    if (word.starts_with("--") && word.find('=') + 1 == word.size()) {
      refuse_empty(word.substr(0, word.size() - 1));
    }
  }
}

/// CLI11 reads nan as a number, and its ranges hold it.
void refuse_nan(const CLI::Option& option) {
  if (!option.get_type_name().starts_with("FLOAT")) return;
  for (const std::string& value : option.results()) {
    if (!std::isnan(std::strtod(value.c_str(), nullptr))) continue;
    throw CLI::ValidationError(option.get_name(), value + " is no number; give one, such as 0.5");
  }
}

/// Of a command line that was read.
void refuse_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const Names& values = option->results();
    if (option->get_items_expected_min() > 0 && contains(values, "")) {
      refuse_empty(option->get_name());
    }
    refuse_nan(*option);
  }
  for (const CLI::App* command : app.get_subcommands()) refuse_values(*command);
}

}  // namespace

void parse(CLI::App& program, std::vector<std::string> words) {
  refuse_empty_behind_sign(words);
  std::ranges::reverse(words);  // as CLI11 takes them
  program.parse(std::move(words));
  refuse_values(program);
}

std::string usage_text(const CLI::App& program, const CLI::ParseError& error) {
  const Command command = command_of(program);
  const bool lacks_command = command.app->get_require_subcommand_min() > 0;
  std::string text = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && lacks_command) {
    text = missing_command(command);
  } else if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !command.app->remaining().empty()) {
    text = unexpected_word(program, command);
  }
  const std::string_view prefix = std::string_view(command.words).substr(program.get_name().size());
  return (prefix.empty() ? "" : std::string(prefix.substr(1)) + ": ") + text + "; see " + command.words +
         " --help";
}

}  // namespace stilt::program
