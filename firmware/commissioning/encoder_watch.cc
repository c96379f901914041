#include "firmware/commissioning/encoder_watch.h"

#include <algorithm>
#include <cmath>

#include "firmware/commissioning/formatted.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/supervisor/detectors.h"

namespace stilt::commissioning {
namespace {

/// In the 25 replies of the shipped bound an angle changes by 3.8 mrad at this rate. The coarsest steps
/// are 1.7 mrad, of an AK 3, whose replies are 2 ms apart.
constexpr double kTurns_rad_s = 0.15;

}  // namespace

std::string EncoderWatch::trouble(const hal::JointReading& reading, double wanted_Nm) {
  const char* name = control_loop::kJointNames[joint_];
  const double jump_rad = supervisor::encoder_jump_rad(before_, reading);
  before_ = reading;
  if (jump_rad > parameters_.encoder_jump_rad) {
    return formatted("the encoder of %s jumped by %.2f rad: look at its cable and magnet", name, jump_rad);
  }
  if (reading.unchanged_replies == 0) least_Nm_ = most_Nm_ = wanted_Nm;
  least_Nm_ = std::min(least_Nm_, wanted_Nm);
  most_Nm_ = std::max(most_Nm_, wanted_Nm);
  if (!supervisor::encoder_repeats(reading, parameters_)) return "";
  if (std::abs(reading.velocity_rad_s) > kTurns_rad_s) {
    return formatted(
        "the encoder of %s is frozen: it reports %.2f rad/s and one angle; look at its cable and magnet",
        name, reading.velocity_rad_s);
  }
  if (most_Nm_ - least_Nm_ > held_Nm_) {
    return formatted("%s does not follow: its encoder is frozen, or something holds the joint", name);
  }
  return "";
}

}  // namespace stilt::commissioning
