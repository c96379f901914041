#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "firmware/commissioning/jog.h"
#include "firmware/configuration/hardware.h"

/// What a jog and a person's eyes say together of the wiring of a joint. Pure.
namespace stilt::commissioning {

/// Of a link, seen from the robot's right side. A positive joint angle swings it backward.
enum class Way { backward, forward };

/// What the person saw. A link has the number of the joint above it: left thigh, left shin, right thigh,
/// right shin.
struct Sighting {
  std::optional<std::size_t> link;  ///< nothing: no link moved
  Way way = Way::backward;          ///< of its first motion
  std::optional<double> angle_rad;  ///< how far it turned, if measured
};

/// What is wired wrongly, by a jog.
enum class Finding {
  correct,
  exchanged_motors,    ///< another link moved, of the same leg or across
  exchanged_legs,      ///< the same link of the other leg moved
  exchanged_encoders,  ///< the right link moved, and another joint's encoder
  reversed_joint,      ///< motor and encoder both
  reversed_motor,
  reversed_encoder,
  wrong_ratio,
  wrong_speed,    ///< velocities are not those of the positions
  dead_joint,     ///< no torque
  blocked_joint,  ///< torque, and no motion
  dead_encoder,   ///< a link moved, and no encoder
  loose_link,     ///< the encoder moved, and no link
};
[[nodiscard]] const char* name(Finding finding);

/// A finding and its sentence.
struct Verdict {
  Finding finding = Finding::correct;
  std::string sentence;  ///< what is wrong, and what mends it
};

/// @param driver  of the joint in the configuration
[[nodiscard]] Verdict judge(std::size_t joint, const JogMotion& motion, const Sighting& seen,
                            const configuration::DriverParameters& driver);

/// "left thigh", ...
[[nodiscard]] const char* link_name(std::size_t joint);

}  // namespace stilt::commissioning
