#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "host_tools/web/monitor/terminal_view.h"

namespace stilt::monitor {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> interrupted = false;

/// While this object exists, the terminal delivers single keys without echo and shows its alternate screen.
class RawTerminal {
 public:
  RawTerminal() {
    is_terminal_ = tcgetattr(STDIN_FILENO, &before_) == 0;
    if (is_terminal_) {
      termios raw = before_;
      raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
      tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    }
    std::fputs("\x1b[?1049h\x1b[?25l", stdout);
  }
  ~RawTerminal() {
    std::fputs("\x1b[?25h\x1b[?1049l", stdout);
    std::fflush(stdout);
    if (is_terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  termios before_{};
  bool is_terminal_ = false;
};

struct Size {
  std::size_t columns = 100, rows = 40;
};

/// Present size of the terminal, which may change at any time.
Size terminal_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row < 3) return {};
  return {size.ws_col, size.ws_row};
}

/// True after q, or the end of the input.
bool wants_to_quit() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (::poll(&input, 1, 0) > 0) {
    char key = 0;
    if (::read(STDIN_FILENO, &key, 1) != 1 || key == 'q' || key == 'Q') return true;
  }
  return false;
}

/// Overwrites the previous text, so that the screen does not flicker. Highlights faults and stale data.
void show(const std::string& text) {
  constexpr std::string_view kStandOut[] = {"FAULT", "STALE DATA: "};
  std::string screen = "\x1b[H";
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool stands_out = std::ranges::any_of(
        kStandOut, [&](std::string_view word) { return text.compare(at, word.size(), word) == 0; });
    if (stands_out) screen += "\x1b[1;31m";
    if (text[at] == '\n') screen += "\x1b[0m\x1b[K\r";
    screen += text[at];
  }
  screen += "\x1b[Kq quits\x1b[K\x1b[J";
  std::fputs(screen.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

int run_terminal(SampleSource& source) {
  const char* kind = std::getenv("TERM");
  if (isatty(STDOUT_FILENO) == 0 || kind == nullptr || std::string_view(kind) == "dumb") {
    throw std::runtime_error(
        "--terminal: standard output is no terminal that can be drawn on; stilt record and stilt log csv "
        "write "
        "to files");
  }
  constexpr auto kPoll = std::chrono::milliseconds(20);
  constexpr double kDrawPeriod_s = 0.2;
  struct sigaction action{};
  action.sa_handler = [](int) { interrupted.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  TerminalView view(source);
  const RawTerminal terminal;
  const auto start = Clock::now();
  double drawn_s = -1.0;
  while (!interrupted.load() && !wants_to_quit()) {
    const double now_s = std::chrono::duration<double>(Clock::now() - start).count();
    view.step(now_s);
    if (now_s - drawn_s > kDrawPeriod_s) {
      drawn_s = now_s;
      const Size size = terminal_size();
      show(view.text(size.columns, size.rows - 1));
    }
    std::this_thread::sleep_for(kPoll);
  }
  return 0;
}

}  // namespace stilt::monitor
