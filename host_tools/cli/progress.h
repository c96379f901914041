#pragma once

#include <chrono>
#include <string>

namespace stilt::cli {

/// Progress of a long command on standard error: nothing in the first second; then one line that is rewritten
/// on a terminal, or a plain line every five seconds elsewhere.
class Progress {
 public:
  /// `what` names the work, `total` is its size in `unit`; infinite: not known.
  Progress(std::string what, double total, std::string unit);
  /// Clears the line on a terminal.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// So much is done.
  void update(double done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  double total_;
  std::string unit_;
  bool is_terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

}  // namespace stilt::cli
