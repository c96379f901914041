#include "tests/two_processes/person.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>
#include <utility>

namespace stilt::two_processes {

Pipe::Pipe(std::string name) : name_(std::move(name)) {
  if (mkfifo(name_.c_str(), 0600) == 0) descriptor_ = open(name_.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) throw std::runtime_error(name_ + ": no pipe");
}

Pipe::~Pipe() { close(descriptor_); }

void Pipe::write(const std::string& text) const {
  EXPECT_EQ(::write(descriptor_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
}

bool HelpingPerson::does(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) hands_.write(line + "\n");
  lines_ += static_cast<int>(lines.size());
  const std::string done = "hands: " + std::to_string(lines_) + ": " + lines.back() + ": done";
  return wait_for_text(run_.file("robot.err"), done, kLongestRun_s);
}

void HelpingPerson::lets_go() {
  hands_.write("let go\n");
  ++lines_;
}

bool HelpingPerson::at_question(const std::string& question, const std::vector<std::string>& lines) {
  if (!wait_for_text(run_.file("controller.err"), question, kLongestRun_s) || !does(lines)) return false;
  keyboard_.write("\n");
  return true;
}

void HelpingPerson::calibrates() {
  for (const std::string leg : {"L", "R"}) {
    const std::string hip = "hip_" + leg, knee = "knee_" + leg;
    ASSERT_TRUE(at_question("(" + hip + " at -1.600", {knee + " 0", hip + " -1.6"})) << run_.said();
    ASSERT_TRUE(at_question("(" + hip + " at 1.600", {hip + " 1.6"})) << run_.said();
    ASSERT_TRUE(at_question("(" + knee + " at 0.000", {hip + " 0", knee + " 0"})) << run_.said();
    ASSERT_TRUE(at_question("(" + knee + " at 2.400", {knee + " 2.4"})) << run_.said();
  }
  ASSERT_TRUE(at_question("Release the legs", {"knee_L 0", "knee_R 0", "let go", "torso 0"})) << run_.said();
  ASSERT_TRUE(at_question("rock the torso", {"rock"})) << run_.said();
}

}  // namespace stilt::two_processes
