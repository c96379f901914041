#include "host_tools/cli/published_command.h"

namespace stilt::cli {

std::string published_command(const std::vector<std::string>& arguments) {
  std::string command = "stilt";
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const std::string option = word.substr(0, word.find('='));
    const bool has_value = option == "--out" || option == "--json" || option == "--processes";
    if (option == "--out") command += " --out DIR";
    if (has_value && option == word) ++i;  // its value is the next word
    if (!has_value && option != "--merge") command += " " + word;
  }
  return command;
}

}  // namespace stilt::cli
