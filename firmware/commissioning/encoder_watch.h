#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "firmware/supervisor/parameters.h"
#include "hal/robot/joint_bus.h"

/// Whether a joint's encoder may close a loop of torque.
namespace stilt::commissioning {

/// Change of torque over which friction may hold a joint, as a share of its limit: friction of 1/16 either
/// way.
inline constexpr double kHeldShare = 1.0 / 8.0;

/// Finds an encoder that jumps or freezes while its joint is driven, by the supervisor's bounds. A joint that
/// is slow, or turns round, may stick for longer than an encoder may repeat its value. So a value that
/// repeats counts where the encoder reports a rate with it, or where the torque changed by more than friction
/// holds.
class EncoderWatch {
 public:
  /// @param held_Nm  change of torque over which friction may hold the joint
  EncoderWatch(std::size_t joint, double held_Nm, const supervisor::SupervisorParameters& parameters)
      : joint_(joint), held_Nm_(held_Nm), parameters_(parameters) {}

  /// To be called once per tick.
  /// @param wanted_Nm  by target and reading, before its limit
  /// @return  what is wrong, with the joint's name; empty: nothing
  [[nodiscard]] std::string trouble(const hal::JointReading& reading, double wanted_Nm);

 private:
  std::size_t joint_;
  double held_Nm_;
  supervisor::SupervisorParameters parameters_;
  hal::JointReading before_;
  double least_Nm_ = std::numeric_limits<double>::infinity();  ///< since the reading changed
  double most_Nm_ = -std::numeric_limits<double>::infinity();
};

}  // namespace stilt::commissioning
