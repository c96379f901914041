#include "firmware/program/terminal_person.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <utility>

#include "firmware/diagnostics/input_file.h"

namespace stilt::program {

std::expected<TerminalPerson, std::string> TerminalPerson::open(const std::string& file) {
  TerminalPerson person;
  if (file.empty()) {
    person.patient_ = isatty(STDIN_FILENO) == 1;
    return person;
  }
  auto answers = diagnostics::read_file(file);
  if (!answers || answers->empty()) {
    return std::unexpected("--answers " + file + ": " +
                           (answers ? "is empty" : "cannot be read (" + answers.error() + ")") +
                           "; name a file with an answer a line");
  }
  person.pending_ = std::move(*answers);
  person.ended_ = true;
  return person;
}

/// What was typed before the question answers another one.
void TerminalPerson::ask(const std::string& question) {
  if (patient_) {
    static_cast<void>(tcflush(STDIN_FILENO, TCIFLUSH));  // fails where the terminal is gone
    pending_.clear();
  }
  std::fprintf(stderr, "%s: ", question.c_str());
}

std::optional<std::string> TerminalPerson::answer() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (!ended_ && pending_.find('\n') == std::string::npos && ::poll(&input, 1, 0) > 0) {
    std::array<char, 256> bytes;
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    ended_ = count <= 0;
    if (count > 0) pending_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  const std::size_t end = pending_.find('\n');
  if (end == std::string::npos && !ended_) return std::nullopt;
  if (pending_.empty()) return std::nullopt;
  std::string line = pending_.substr(0, end);
  pending_.erase(0, end == std::string::npos ? end : end + 1);
  return line;
}

}  // namespace stilt::program
