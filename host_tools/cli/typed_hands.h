#pragma once

#include <string>

#include "host_tools/simulation/robot_on_bus/hand_commands.h"

namespace stilt::cli {

/// Hands on the simulated robot that somebody moves by lines, from a terminal, a FIFO or a file.
class TypedHands {
 public:
  static constexpr const char* kLines = robot_on_bus::HandCommands::kLines;

  /// Throws UsageError, one sentence, when it cannot be read.
  /// @param file  "-": standard input; empty: no hands
  explicit TypedHands(const std::string& file);
  ~TypedHands();
  TypedHands(const TypedHands&) = delete;
  TypedHands& operator=(const TypedHands&) = delete;

  /// Once per tick: reads what has come, without waiting, and reports lines that are done. A line that is
  /// none is reported on a terminal, where it can be typed again; elsewhere it throws UsageError.
  void serve(robot_on_bus::RobotOnBus& robot);

 private:
  void read_more();

  std::string file_;
  int descriptor_ = -1;  ///< negative: no hands
  bool patient_ = false;
  robot_on_bus::HandCommands commands_;
};

}  // namespace stilt::cli
