#pragma once

#include <string>
#include <vector>

#include "tests/two_processes/robot_and_controller.h"

namespace stilt::two_processes {

/// A pipe with a name. It does not end as long as this lives.
class Pipe {
 public:
  /// Throws std::runtime_error when it cannot be made.
  explicit Pipe(std::string name);
  ~Pipe();
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  void write(const std::string& text) const;

 private:
  std::string name_;
  int descriptor_ = -1;
};

/// A person at the keyboard of stiltd who has hands on the robot of `stilt robot --hands`. Does what a
/// question asks for, and presses Enter when it is done.
class HelpingPerson {
 public:
  HelpingPerson(const RobotAndController& run, const Pipe& hands, const Pipe& keyboard)
      : run_(run), hands_(hands), keyboard_(keyboard) {}

  /// All that `stiltd calibrate` asks for, between the end stops. Fails the test when a question does not
  /// come, or the hands do not do it.
  void calibrates();

  /// When the robot goes on.
  void lets_go();

  /// False: the hands do not do it.
  [[nodiscard]] bool does(const std::vector<std::string>& lines);

 private:
  [[nodiscard]] bool at_question(const std::string& question, const std::vector<std::string>& lines);

  const RobotAndController& run_;
  const Pipe& hands_;
  const Pipe& keyboard_;
  int lines_ = 0;  ///< that the hands have got
};

}  // namespace stilt::two_processes
