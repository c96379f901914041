#include "firmware/program/terminal_person.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

#include "tests/own_folder.h"
#include "tests/pseudo_terminal.h"

namespace stilt::program {
namespace {

/// Standard input while the object lives.
class StandardInput {
 public:
  explicit StandardInput(int descriptor) : before_(dup(STDIN_FILENO)) {
    dup2(descriptor, STDIN_FILENO);
    close(descriptor);
  }
  ~StandardInput() {
    dup2(before_, STDIN_FILENO);
    close(before_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

 private:
  int before_;
};

void type(const tests::PseudoTerminal& terminal, std::string_view text) {
  terminal.write(std::vector<std::uint8_t>(text.begin(), text.end()));
  pollfd input{STDIN_FILENO, POLLIN, 0};
  ASSERT_EQ(poll(&input, 1, 10'000), 1);
}

TEST(TerminalPerson, WhatWasTypedBeforeAQuestionDoesNotAnswerIt) {
  const tests::PseudoTerminal terminal;
  const StandardInput input(open(terminal.port().c_str(), O_RDWR | O_NOCTTY));
  auto person = TerminalPerson::open("");
  ASSERT_TRUE(person);
  EXPECT_TRUE(person->patient());
  type(terminal, "first\nsecond\n");
  EXPECT_EQ(person->answer(), "first");
  type(terminal, "third\n");
  person->ask("question");
  EXPECT_EQ(person->answer(), std::nullopt);
  type(terminal, "half\x04");  // Ctrl-D: a terminal gives what there is of the line
  EXPECT_EQ(person->answer(), std::nullopt);
  person->ask("question");
  type(terminal, "fourth\n");
  EXPECT_EQ(person->answer(), "fourth");
}

TEST(TerminalPerson, AnswersOfAPipeAndOfAFileWaitForTheirQuestions) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "first\nsecond\n", 13), 13);
  close(ends[1]);
  const StandardInput input(ends[0]);
  const tests::OwnFolder folder;
  std::ofstream(folder.file("answers")) << "first\nsecond\n";
  for (const std::string& file : {std::string(), folder.file("answers")}) {
    auto person = TerminalPerson::open(file);
    ASSERT_TRUE(person);
    EXPECT_FALSE(person->patient());
    for (const char* answer : {"first", "second"}) {
      person->ask("question");
      EXPECT_EQ(person->answer(), answer);
    }
  }
}

}  // namespace
}  // namespace stilt::program
