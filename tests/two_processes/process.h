#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace stilt::two_processes {

/// A program that runs beside the test, its output in files. Killed when the object goes.
class Process {
 public:
  /// Throws std::runtime_error when it cannot be started.
  /// @param words  program and arguments
  /// @param output, errors  files for standard output and standard error
  /// @param input  for standard input; empty: that of the test
  Process(const std::vector<std::string>& words, const std::string& output, const std::string& errors,
          const std::string& input = "");
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits for the end, at most that long. Exit status, 128 + signal, or nothing when it still runs.
  [[nodiscard]] std::optional<int> wait(double longest_s);

  void signal(int number) const;
  /// True: the signal was sent, and no thread has taken it yet.
  [[nodiscard]] bool has_pending(int number) const;
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
  std::optional<int> status_;
};

/// Waits until a file holds a text, at most that long.
[[nodiscard]] bool wait_for_text(const std::string& file, const std::string& text, double longest_s);

[[nodiscard]] std::string text_of(const std::string& file);

}  // namespace stilt::two_processes
