#include "tests/two_processes/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace stilt::two_processes {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr auto kPause = std::chrono::milliseconds(5);

/// Asks again and again until the answer is yes; no after that long.
template <class Question>
bool wait_until(double longest_s, Question&& question) {
  const auto end = SteadyClock::now() + std::chrono::duration<double>(longest_s);
  while (!question()) {
    if (SteadyClock::now() > end) return false;
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

}  // namespace

Process::Process(const std::vector<std::string>& words, const std::string& output, const std::string& errors,
                 const std::string& input) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!input.empty()) posix_spawn_file_actions_addopen(&actions, 0, input.c_str(), O_RDWR, 0);
  posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), kFlags, 0644);
  posix_spawn_file_actions_addopen(&actions, 2, errors.c_str(), kFlags, 0644);
  const int failure = posix_spawn(&id_, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::runtime_error(words[0] + " cannot be started");
}

Process::~Process() {
  if (status_) return;
  ::kill(id_, SIGKILL);
  ::waitpid(id_, nullptr, 0);
}

std::optional<int> Process::wait(double longest_s) {
  wait_until(longest_s, [this] {
    int status = 0;
    if (!status_ && ::waitpid(id_, &status, WNOHANG) == id_) {
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return status_.has_value();
  });
  return status_;
}

void Process::signal(int number) const {
  if (!status_) ::kill(id_, number);
}

bool Process::has_pending(int number) const {
  const std::string status = text_of("/proc/" + std::to_string(id_) + "/status");
  const std::string key = "\nShdPnd:\t";
  const std::size_t at = status.find(key);
  if (at == std::string::npos) return false;
  return (std::stoull(status.substr(at + key.size(), 16), nullptr, 16) >> (number - 1) & 1U) != 0;
}

bool wait_for_text(const std::string& file, const std::string& text, double longest_s) {
  return wait_until(longest_s, [&] { return text_of(file).find(text) != std::string::npos; });
}

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

}  // namespace stilt::two_processes
