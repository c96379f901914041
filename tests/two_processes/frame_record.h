#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/mit/mit_mode.h"
#include "hal/robot/robot_wiring.h"

namespace stilt::two_processes {

/// A frame of the log that `stilt robot --frames` writes.
struct RecordedFrame {
  std::uint64_t tick = 0;
  std::size_t bus = 0;
  bool from_controller = false;
  hal::CanFrame frame;
};

/// The classic frames of a log; throws std::runtime_error when a line is not one.
[[nodiscard]] std::vector<RecordedFrame> read_frames(const std::string& file);

/// What the controller asked of the shipped robot's drivers, and what they reported.
struct MotorTraffic {
  struct Command {
    std::uint64_t tick = 0;
    std::size_t joint = 0;
    hal::mit::MitCommand asked;
  };
  struct Special {
    std::uint64_t tick = 0;
    std::size_t joint = 0;
    hal::mit::MitSpecial what{};
  };
  struct Reply {
    std::uint64_t tick = 0;
    std::size_t joint = 0;
    hal::mit::MitReply said;
  };
  std::vector<Command> commands;
  std::vector<Special> specials;
  std::vector<Reply> replies;
};

[[nodiscard]] MotorTraffic motor_traffic(const std::vector<RecordedFrame>& frames,
                                         const hal::RobotWiring& wiring);

}  // namespace stilt::two_processes
