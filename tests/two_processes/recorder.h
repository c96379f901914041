#pragma once

#include <csignal>
#include <memory>
#include <optional>
#include <string>

#include "tests/own_domain.h"
#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {

/// `stilt record` beside a robot and its controller.
class Recorder {
 public:
  /// Starts and waits until it records.
  Recorder(const RobotAndController& run, const std::string& file)
      : process_({STILT_PROGRAM, "record", "--out", file, "--domain", std::to_string(tests::own_domain()),
                  "--json", run.file("record.json")},
                 run.file("record.out"), run.file("record.err")),
        records_(wait_for_text(run.file("record.err"), "recording to", kLongestRun_s)) {}

  [[nodiscard]] bool records() const { return records_; }
  [[nodiscard]] Process& process() { return process_; }

  /// Exit status after the signal to end.
  std::optional<int> end() {
    process_.signal(SIGINT);
    return process_.wait(kLongestRun_s);
  }

 private:
  Process process_;
  bool records_;
};

}  // namespace stilt::two_processes
