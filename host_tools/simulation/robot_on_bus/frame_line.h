#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/can/frame.h"
#include "host_tools/simulation/closed_loop/fault_plan.h"

namespace stilt::robot_on_bus {

/// Origin of a frame of the robot.
struct FrameSource {
  std::size_t bus = 0;
  std::optional<std::size_t> joint;  ///< none: the torso sensor
};

/// Frames on their way from the robot to the controller, and the effects of the active faults on them. Frames
/// without delay keep their order. Deterministic.
class FrameLine {
 public:
  explicit FrameLine(std::span<const simulation::TimedFault> faults)
      : faults_(faults.begin(), faults.end()) {}

  /// Applies the faults that are active at `time_s`.
  void send(double time_s, std::int64_t now_ns, const FrameSource& source, const hal::CanFrame& frame);

  /// Whether a frame of the controller is lost before it reaches a joint.
  [[nodiscard]] bool lost(double time_s, std::size_t bus, std::size_t joint) const;

  /// Takes the frames that have arrived on a bus by now.
  [[nodiscard]] std::vector<hal::CanFrame> arrived(std::int64_t now_ns, std::size_t bus);

 private:
  struct Pending {
    std::size_t bus = 0;
    std::int64_t due_ns = 0;
    hal::CanFrame frame;
  };
  [[nodiscard]] hal::CanFrame corrupted(hal::CanFrame frame);

  std::vector<simulation::TimedFault> faults_;
  std::vector<Pending> pending_;
  std::uint64_t corruptions_ = 0;
};

inline constexpr std::int64_t kFrameDelay_ns = 5'000'000;

}  // namespace stilt::robot_on_bus
