#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <string>

/// What stiltd answers to a command line, for tests of the program as a user runs it.
namespace stilt::testing_support {

struct Answer {
  int status = -1;
  std::string text;  ///< both outputs
};

[[nodiscard]] inline Answer answer(const std::string& command) {
  Answer run;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) run.text += buffer;
  run.status = WEXITSTATUS(pclose(pipe));
  return run;
}

[[nodiscard]] inline Answer stiltd(const std::string& arguments) {
  return answer(STILTD " " + arguments + " 2>&1");
}

[[nodiscard]] inline bool has(const Answer& run, const std::string& part) {
  return run.text.find(part) != std::string::npos;
}

}  // namespace stilt::testing_support
