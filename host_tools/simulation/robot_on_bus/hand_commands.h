#pragma once

#include <string>
#include <string_view>

#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"

namespace stilt::robot_on_bus {

/// What there is to report about a line; an empty sentence: nothing.
struct HandReport {
  std::string sentence;
  bool bad_line = false;
};

/// What somebody types for the hands on a hanging robot, a line each, done one after the other:
///
///   hip_L -1.6   moves a joint, or the torso, to an angle in rad and holds it there
///   rock         holds the left thigh still and rocks the torso by 0.2 rad, until the next line; done after
///                three times
///   let go       leaves everything; done when the legs hang still
class HandCommands {
 public:
  static constexpr const char* kLines = "JOINT RAD, torso RAD, rock, let go";

  /// Bytes as they come; lines end with '\n'.
  void type(std::string_view bytes) { typed_ += bytes; }
  /// Nothing more comes of a line that has begun.
  void end_line() {
    if (!typed_.empty() && typed_.back() != '\n') typed_ += '\n';
  }

  /// Once per tick. Reports a line that is done, "2: hip_L -1.6: done" for the second, or that is none.
  [[nodiscard]] HandReport serve(RobotOnBus& robot);

 private:
  [[nodiscard]] HandReport begin(RobotOnBus& robot);
  [[nodiscard]] bool move(const std::string& name, const std::string& angle, RobotOnBus& robot);
  void rock(RobotOnBus& robot) const;

  std::string typed_;   ///< and not begun
  std::string line_;    ///< that the hands are at; empty: none
  int lines_ = 0;       ///< begun
  double began_s_ = 0;  ///< on the robot's clock
  double lasts_s_ = 0;
  bool rocks_ = false;
};

}  // namespace stilt::robot_on_bus
