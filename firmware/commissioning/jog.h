#pragma once

#include <cstddef>
#include <expected>
#include <limits>
#include <optional>
#include <string>

#include "firmware/commissioning/session.h"
#include "firmware/supervisor/parameters.h"
#include "mpc_core/model/robot.h"

/// One joint moves slowly with little torque, the others limp: what its encoder reports. Ordinary threads.
namespace stilt::commissioning {

/// Most torque of a joint, as a share of its limit.
inline constexpr double kJogTorqueShare = 0.2;
inline constexpr double kSmallestJog_rad = 0.08;
inline constexpr double kLargestJog_rad = 0.5;

/// Which joint is moved, how far, and with how much torque.
struct JogRequest {
  std::size_t joint = 0;
  double angle_rad = 0.0;  ///< from where the joint hangs; kSmallestJog_rad to kLargestJog_rad, either way
  double torque_limit_Nm = 0.0;           ///< all of the joint's
  double torque_share = kJogTorqueShare;  ///< of it that is used; never more than kJogTorqueShare
  double push_Nm = 0.0;                   ///< most torque until an encoder has moved
  double kp_Nm_rad = 0.0;                 ///< of the slow motion, closed here: drivers get a torque alone
  double kd_Nms_rad = 0.0;
  supervisor::SupervisorParameters supervisor = {};  ///< when the encoder is frozen, or jumps
};

/// All that a joint may get: the smaller share of its limit.
[[nodiscard]] double most_torque_Nm(const JogRequest& request);

/// JogRequest::push_Nm to begin with: gravity's torque with the leg, or the shin, 0.3 rad from plumb, and
/// 1/80 of the joint's limit for friction. A leg whose encoder is dead does not swing to its stop with that.
[[nodiscard]] double first_push_Nm(const model::RobotModel& robot, std::size_t joint);

/// What the encoders did when the torque grew.
enum class Response {
  with_torque,     ///< the joint's encoder moved the way of the torque
  against_torque,  ///< the other way
  other,           ///< it stood still, and that of JogMotion::other moved
  none,            ///< nothing moved
};
[[nodiscard]] const char* name(Response response);

/// What moved, and at which torque.
struct JogMotion {
  Response response = Response::none;
  std::optional<std::size_t> other;
  int direction = 1;                ///< of the torque that moved something; of `none` that of the last push
  double breakaway_Nm = 0.0;        ///< torque at which it moved; of `none` the largest tried
  double reported_torque_Nm = 0.0;  ///< by the driver at that moment, NaN: not reported
  double leg_rad = 0.0;             ///< motion of the leg's other encoder at that moment
  double reached_rad = 0.0;         ///< by the encoder, farthest from the start
  double leg_reached_rad = 0.0;     ///< motion of the leg's other encoder there
  /// Integral of the reported velocity over the change of the position, there and back. NaN: not measured.
  double velocity_factor = std::numeric_limits<double>::quiet_NaN();
  double peak_torque_Nm = 0.0;  ///< asked for
  bool completed = false;       ///< it went all the way and back; only tried with_torque
};

/// Needs drivers that are up, and leaves them limp.
///
/// First a torque grows to JogRequest::push_Nm until an encoder has moved by 0.05 rad: without feedback, so
/// that wrong signs cannot run away. When nothing moves, it grows the other way: a joint may be at its stop.
/// Only a joint whose encoder follows the torque then goes to the angle and back, at 0.2 rad/s. The torque of
/// that motion is limited to what the first part needed, more for the larger angle, and to
/// JogRequest::torque_share.
/// @return  the error says what stopped it: emergency stop, silent or faulty driver, legs that swing, a joint
///          that turns faster than 2 rad/s. Or that the loop stood still while the joint had torque
[[nodiscard]] std::expected<JogMotion, std::string> jog(Session& session, const JogRequest& request);

}  // namespace stilt::commissioning
