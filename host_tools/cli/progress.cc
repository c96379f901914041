#include "host_tools/cli/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace stilt::cli {
namespace {

constexpr auto kQuiet = std::chrono::seconds(1);
constexpr auto kTerminalInterval = std::chrono::milliseconds(200);
constexpr auto kPlainInterval = std::chrono::seconds(5);

}  // namespace

Progress::Progress(std::string what, double total, std::string unit)
    : what_(std::move(what)),
      total_(total),
      unit_(std::move(unit)),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      next_(Clock::now() + kQuiet) {}

Progress::~Progress() {
  if (shown_ && is_terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double done) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s: %.0f of %.0f %s" : "%s: %.0f of %.0f %s\n", what_.c_str(),
               done, total_, unit_.c_str());
  std::fflush(stderr);
  shown_ = true;
  next_ = now;
  next_ += is_terminal_ ? Clock::duration(kTerminalInterval) : Clock::duration(kPlainInterval);
}

}  // namespace stilt::cli
