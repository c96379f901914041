#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/own_folder.h"

namespace stilt::testing_support {

/// What a run of the program left: exit status (-1: it did not exit by itself), standard output and errors.
struct Outcome {
  int status = -1;
  std::string output, errors;
};

[[nodiscard]] inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Runs the program STILT_PROGRAM in a shell; every test has an empty folder of its own.
class ProgramTest : public testing::Test {
 protected:
  /// A path in the test's folder.
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  [[nodiscard]] Outcome run(const std::string& arguments, const std::string& input = "") const {
    std::ofstream(file("in")) << input;
    const std::string command = std::string(STILT_PROGRAM) + " " + arguments + " <" + file("in") + " >" +
                                file("out") + " 2>" + file("err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(file("out")), text_of(file("err"))};
  }

 private:
  tests::OwnFolder folder_;
};

}  // namespace stilt::testing_support
