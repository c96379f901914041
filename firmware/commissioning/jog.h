#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <string>

#include "firmware/commissioning/session.h"

/// One joint moves slowly with little torque, the others limp: what its encoder reports. Ordinary threads.
namespace stilt::commissioning {

/// Most torque of a joint, as a share of its limit.
inline constexpr double kJogTorqueShare = 0.2;
inline constexpr double kSmallestJog_rad = 0.08;
inline constexpr double kLargestJog_rad = 0.5;

struct JogRequest {
  std::size_t joint = 0;
  double angle_rad = 0.0;  ///< from where the joint hangs; kSmallestJog_rad to kLargestJog_rad, either way
  double torque_limit_Nm = 0.0;           ///< all of the joint's
  double torque_share = kJogTorqueShare;  ///< of it that is used; never more than kJogTorqueShare
  double kp_Nm_rad = 0.0;                 ///< of the slow motion, closed here: drivers get a torque alone
  double kd_Nms_rad = 0.0;
};

/// What the encoders did when the torque grew.
enum class Response {
  with_torque,     ///< the joint's encoder moved the way of the torque
  against_torque,  ///< the other way
  other,           ///< it stood still, and that of JogMotion::other moved
  none,            ///< nothing moved
};
[[nodiscard]] const char* name(Response response);

struct JogMotion {
  Response response = Response::none;
  std::optional<std::size_t> other;
  double breakaway_Nm = 0.0;        ///< torque at which it moved; of `none` the largest tried
  double reported_torque_Nm = 0.0;  ///< by the driver at that moment, NaN: not reported
  double leg_rad = 0.0;             ///< motion of the leg's other encoder at that moment
  double reached_rad = 0.0;         ///< by the encoder, farthest from the start
  double peak_torque_Nm = 0.0;      ///< asked for
  bool completed = false;           ///< it went all the way and back; only tried with_torque
};

/// Needs drivers that are up, and leaves them limp.
///
/// First a torque grows until an encoder has moved by 0.05 rad: without feedback, so that wrong signs cannot
/// run away. Only a joint whose encoder follows the torque then goes to the angle and back, at 0.2 rad/s.
/// The torque of that motion is limited to what the first part needed, more for the larger angle, and to
/// JogRequest::torque_share.
/// @return  the error says what stopped it: emergency stop, silent or faulty driver, legs that swing
[[nodiscard]] std::expected<JogMotion, std::string> jog(Session& session, const JogRequest& request);

}  // namespace stilt::commissioning
