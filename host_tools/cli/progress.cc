#include "host_tools/cli/progress.h"

#include <unistd.h>

#include <cmath>
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

void Progress::change(const std::string& what) {
  if (what == what_) return;
  what_ = what;
  shown_done_ = -1.0;
}

void Progress::update(double done) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  if (!is_terminal_ && done == shown_done_) return;
  shown_done_ = done;
  char goal[40] = "";
  if (std::isfinite(total_)) std::snprintf(goal, sizeof goal, " of %.0f", total_);
  std::fprintf(stderr, is_terminal_ ? "\r\033[K%s: %.0f%s %s" : "%s: %.0f%s %s\n", what_.c_str(), done, goal,
               unit_.c_str());
  std::fflush(stderr);
  shown_ = true;
  next_ = now;
  next_ += is_terminal_ ? Clock::duration(kTerminalInterval) : Clock::duration(kPlainInterval);
}

}  // namespace stilt::cli
