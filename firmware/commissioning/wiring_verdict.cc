#include "firmware/commissioning/wiring_verdict.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

/// Seen and read angles that differ by more than this factor are of different gears; an eye is that good.
constexpr double kRatioTolerance = 1.4;
/// Velocities of drivers are coarse and late, and their integral is nearer than this to the positions.
constexpr double kSpeedTolerance = 1.2;
/// Of the asked torque: a driver that reports less gives none.
constexpr double kGivenShare = 0.5;
/// Of the own encoder's motion: what the leg's other encoder moves when the two are exchanged.
constexpr double kExchangedShare = 0.5;

std::string joint_name(std::size_t joint) { return control_loop::kJointNames[joint]; }

bool same_leg(std::size_t a, std::size_t b) { return a / 2 == b / 2; }
bool same_link(std::size_t a, std::size_t b) { return a % 2 == b % 2; }
bool is_knee(std::size_t joint) { return joint % 2 == 1; }

bool apart(double factor, double tolerance) { return !(factor < tolerance && factor > 1 / tolerance); }

Verdict exchanged_encoders(std::size_t joint, std::size_t read) {
  return {Finding::exchanged_encoders, "exchanged encoders: the " + std::string(link_name(joint)) +
                                           " moved, and the encoder of " + joint_name(read) +
                                           " reports it; exchange the encoders' cables"};
}

/// A limp shin hangs plumb while its thigh moves, and a thigh gives way when its shin moves. The other joint
/// of the leg turns against the torque. So an own encoder that turns against it, or stands still at a stop,
/// while the other turns with it reads the other joint.
bool reads_other_joint(std::size_t joint, const JogMotion& motion) {
  const bool other_of_leg = motion.response == Response::other && same_leg(*motion.other, joint);
  return (motion.response == Response::against_torque || other_of_leg) &&
         motion.direction * motion.leg_rad > kExchangedShare * std::abs(motion.reached_rad);
}

Verdict other_link(std::size_t joint, std::size_t link) {
  const std::string pair = joint_name(joint) + " and " + joint_name(link);
  const std::string keys = "exchange bus, id and reply_id of " + pair + " in the configuration";
  if (!same_leg(joint, link) && same_link(joint, link)) {
    return {Finding::exchanged_legs, "exchanged legs: the motor of " + joint_name(joint) + " moved the " +
                                         link_name(link) + "; " + keys +
                                         " (of both legs, or the cables of the legs), then jog again"};
  }
  return {Finding::exchanged_motors, "exchanged motors: the motor of " + joint_name(joint) + " moved the " +
                                         link_name(link) + "; " + keys + ", then jog again"};
}

Verdict nothing_moved(std::size_t joint, const JogMotion& motion) {
  const bool gives = std::abs(motion.reported_torque_Nm) > kGivenShare * motion.breakaway_Nm;
  char torque[40];
  std::snprintf(torque, sizeof torque, "%.1f Nm", motion.breakaway_Nm);
  if (gives) {
    return {Finding::blocked_joint, "blocked joint: " + joint_name(joint) +
                                        " does not move either way with " + torque +
                                        ", which its driver reports to give; look for what holds it"};
  }
  return {Finding::dead_joint,
          "dead joint: " + joint_name(joint) + " does not move when asked for " + torque +
              " either way; look at the motor's phases, its power stage and the driver's own limits"};
}

Verdict directions(std::size_t joint, bool motor_right, bool encoder_follows) {
  const std::string name = joint_name(joint);
  if (motor_right && encoder_follows) return {Finding::correct, name + " is wired correctly"};
  if (!motor_right && encoder_follows) {
    return {Finding::reversed_joint, "reversed joint: motor and encoder of " + name +
                                         " turn against the joint; change " + name +
                                         ".reversed in the configuration"};
  }
  const std::string mend =
      "; its driver would run away. Exchange two phases of the motor or the driver's own sign, and calibrate "
      "the driver again";
  if (motor_right) {
    return {Finding::reversed_encoder,
            "reversed encoder: that of " + name + " counts against its motor" + mend};
  }
  return {Finding::reversed_motor, "reversed motor: that of " + name + " turns against its encoder" + mend};
}

bool has_ranges(configuration::DriverProtocol protocol) {
  using configuration::DriverProtocol;
  return protocol == DriverProtocol::mit_mini_cheetah || protocol == DriverProtocol::mit_ak ||
         protocol == DriverProtocol::mit_damiao;
}

/// Velocities agree with positions.
bool right_speed(const JogMotion& motion) { return !apart(motion.velocity_factor, kSpeedTolerance); }

/// A thigh turns with its hip, a shin with both joints: a limp thigh gives way.
double link_turned_rad(std::size_t joint, const JogMotion& motion) {
  return motion.direction * (motion.reached_rad + (is_knee(joint) ? motion.leg_reached_rad : 0.0));
}

Verdict wrong_gear(std::size_t joint, const JogMotion& motion, double seen_rad,
                   const configuration::DriverParameters& driver) {
  const double hip_rad = is_knee(joint) ? motion.leg_reached_rad : 0.0;
  const double ratio = driver.ratio * motion.reached_rad / (motion.direction * seen_rad - hip_rad);
  const std::string encoders =
      is_knee(joint) ? "encoders of " + joint_name(joint - 1) + " and " + joint_name(joint) + " report"
                     : "encoder of " + joint_name(joint) + " reports";
  char text[240];
  std::snprintf(
      text, sizeof text,
      "wrong gear ratio: the %s turned by %.0f degrees where the %s %.0f; the ratio is about %.3g, and "
      "the configuration has %.3g",
      link_name(joint), seen_rad * 180 / M_PI, encoders.c_str(), link_turned_rad(joint, motion) * 180 / M_PI,
      ratio, driver.ratio);
  std::string sentence = text;
  if (has_ranges(driver.protocol) && !right_speed(motion)) {
    sentence += ". Positions and velocities differ, too: first look at position_range_rad of ";
    sentence += control_loop::driver_section(joint);
  }
  return {Finding::wrong_ratio, sentence};
}

/// The keys that velocities depend on, and positions do not.
std::string speed_keys(std::size_t joint, double factor, const configuration::DriverParameters& driver) {
  const std::string section = control_loop::driver_section(joint);
  char text[240];
  if (has_ranges(driver.protocol)) {
    std::snprintf(
        text, sizeof text,
        "velocity_range_rad_s of %s is %.3g, and right would be about %.3g (where position_range_rad is "
        "right)",
        section.c_str(), driver.velocity_range_rad_s, driver.velocity_range_rad_s / factor);
  } else if (driver.protocol == configuration::DriverProtocol::ak_v3) {
    const double both = driver.ak_v3_pole_pairs * driver.ak_v3_gear_ratio;
    std::snprintf(text, sizeof text,
                  "ak_v3_pole_pairs times ak_v3_gear_ratio of %s is %.4g, and right would be about %.3g",
                  section.c_str(), both, both * factor);
  } else {
    std::snprintf(text, sizeof text, "look at the velocity filter and the encoders of its driver");
  }
  return text;
}

Verdict wrong_speed(std::size_t joint, double factor, const configuration::DriverParameters& driver) {
  char text[120];
  std::snprintf(text, sizeof text, "wrong speed: velocities of %s are %.2f times those of its positions; ",
                joint_name(joint).c_str(), factor);
  return {Finding::wrong_speed, text + speed_keys(joint, factor, driver)};
}

/// Of a joint that went the right way to the angle and back.
Verdict scales(std::size_t joint, const JogMotion& motion, const Sighting& seen,
               const configuration::DriverParameters& driver) {
  if (seen.angle_rad && apart(link_turned_rad(joint, motion) / *seen.angle_rad, kRatioTolerance)) {
    return wrong_gear(joint, motion, *seen.angle_rad, driver);
  }
  if (!right_speed(motion)) return wrong_speed(joint, motion.velocity_factor, driver);
  return directions(joint, true, true);
}

}  // namespace

const char* name(Finding finding) {
  constexpr std::array<const char*, 13> kNames = {
      "correct",        "exchanged_motors", "exchanged_legs", "exchanged_encoders", "reversed_joint",
      "reversed_motor", "reversed_encoder", "wrong_ratio",    "wrong_speed",        "dead_joint",
      "blocked_joint",  "dead_encoder",     "loose_link"};
  return kNames[static_cast<std::size_t>(finding)];
}

const char* link_name(std::size_t joint) {
  constexpr std::array<const char*, hal::kJoints> kNames = {"left thigh", "left shin", "right thigh",
                                                            "right shin"};
  return kNames[joint];
}

Verdict judge(std::size_t joint, const JogMotion& motion, const Sighting& seen,
              const configuration::DriverParameters& driver) {
  if (!seen.link) {
    if (motion.response == Response::none) return nothing_moved(joint, motion);
    const std::size_t read = motion.other.value_or(joint);
    return {Finding::loose_link, "loose link: the encoder of " + joint_name(read) +
                                     " moved, and no link; look for a gear or coupling that slips"};
  }
  if (*seen.link == joint && reads_other_joint(joint, motion)) return exchanged_encoders(joint, joint ^ 1U);
  // Limp links of a leg move with one another: the other encoder of the leg proves nothing else.
  const bool own_still = motion.response == Response::none ||
                         (motion.response == Response::other && same_leg(*motion.other, joint));
  if (own_still && (*seen.link == joint || motion.response == Response::none)) {
    return {Finding::dead_encoder, std::string("dead encoder: the ") + link_name(*seen.link) +
                                       " moved, and the encoder of " + joint_name(*seen.link) +
                                       " stood still; look at its cable and magnet"};
  }
  if (*seen.link != joint) return other_link(joint, *seen.link);
  if (motion.response == Response::other) return exchanged_encoders(joint, *motion.other);
  const bool motor_right = (seen.way == Way::backward) == (motion.direction > 0);
  const bool encoder_follows = motion.response == Response::with_torque;
  if (motor_right && encoder_follows && motion.completed) return scales(joint, motion, seen, driver);
  return directions(joint, motor_right, encoder_follows);
}

}  // namespace stilt::commissioning
