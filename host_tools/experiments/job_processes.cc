#include "host_tools/experiments/job_processes.h"

#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <map>
#include <stdexcept>

extern char** environ;

namespace stilt::experiments {
namespace {

pid_t start(std::vector<std::string> command, const std::string& id) {
  command.insert(command.end(), {"--job", id});
  std::vector<char*> argv;
  for (std::string& word : command) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  if (posix_spawn(&process, argv[0], nullptr, nullptr, argv.data(), environ) != 0) {
    throw std::runtime_error("job " + id + ": the process cannot be started");
  }
  return process;
}

}  // namespace

void run_in_processes(const std::vector<std::string>& command, const std::vector<std::string>& ids,
                      int at_once, const std::function<void(int)>& finished) {
  std::signal(SIGCHLD, SIG_DFL);  // a parent may have left it ignored: then no end of a process is reported
  std::map<pid_t, std::string> running;
  std::string failed;
  std::size_t next = 0;
  int done = 0;
  while (!running.empty() || (failed.empty() && next < ids.size())) {
    if (failed.empty() && next < ids.size() && static_cast<int>(running.size()) < at_once) {
      running.emplace(start(command, ids[next]), ids[next]);
      ++next;
      continue;
    }
    int status = 0;
    const pid_t ended = waitpid(-1, &status, 0);
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(std::string("jobs: their ends cannot be waited for (") + std::strerror(errno) +
                               ")");
    }
    const auto process = running.find(ended);
    if (process == running.end()) continue;
    const bool good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (!good && failed.empty()) failed = process->second;
    running.erase(process);
    finished(++done);
  }
  if (!failed.empty()) throw std::runtime_error("job " + failed + " failed; its message is above");
}

}  // namespace stilt::experiments
