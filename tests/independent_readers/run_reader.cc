#include "tests/independent_readers/run_reader.h"

#include <cstdio>
#include <stdexcept>

namespace stilt::independent_readers {
namespace {

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

}  // namespace

nlohmann::json run_reader(const std::string& script, const std::vector<std::string>& arguments) {
  std::string command = quoted(NODE_PROGRAM) + ' ' + quoted(std::string(READERS_FOLDER "/") + script);
  for (const std::string& argument : arguments) command += ' ' + quoted(argument);
  command += " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no process can be started for " + script);
  std::string output;
  char piece[4096];
  for (std::size_t size; (size = fread(piece, 1, sizeof piece, pipe)) > 0;) output.append(piece, size);
  if (pclose(pipe) != 0) {
    throw std::runtime_error(script + " failed; is npm ci done in tests/independent_readers? It printed:\n" +
                             output);
  }
  return nlohmann::json::parse(output);
}

}  // namespace stilt::independent_readers
