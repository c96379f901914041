#pragma once

#include <chrono>
#include <string>

namespace stilt::cli {

/// Progress of a long command on standard error. Prints nothing in the first second, then one line: rewritten
/// on a terminal, or printed every five seconds elsewhere.
class Progress {
 public:
  /// `what` names the work, `total` is its size in `unit`; infinite when it is unknown.
  Progress(std::string what, double total, std::string unit);
  /// Clears the line on a terminal.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Reports the amount done, in `unit`.
  void update(double done);

  /// From now on other work is done. Elsewhere than on a terminal work without progress is reported once.
  void change(const std::string& what);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  double total_;
  std::string unit_;
  bool is_terminal_;
  bool shown_ = false;
  double shown_done_ = -1.0;
  Clock::time_point next_;
};

}  // namespace stilt::cli
