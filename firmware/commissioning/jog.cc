#include "firmware/commissioning/jog.h"

#include <algorithm>
#include <cmath>

#include "firmware/commissioning/encoder_watch.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

constexpr double kMoved_rad = 0.05;      // of an encoder, before it counts
constexpr double kStandsStill = 0.02;    // of another encoder's motion: the joint's own has not moved
constexpr double kTorqueGrowth_s = 3.0;  // from nothing to the largest torque of a push
constexpr double kAtLargest_s = 0.5;     // there
constexpr double kFirstSwing_rad = 0.3;  // gravity of it bounds the first push
constexpr double kFrictionShare = 1.0 / 80.0;
constexpr double kSpeed_rad_s = 0.2;
constexpr double kHold_s = 0.5;
constexpr double kRunaway_rad_s = 2.0;
constexpr double kLost_rad = 0.3;  // behind the slow motion
constexpr double kReserve = 1.5;   // of the torque of the slow motion, over what the first part needed
constexpr double kFirstReadings_s = 0.3;
constexpr double kStill_rad = 0.01;
constexpr double kStill_s = 1.5;  // a leg that swings stands still for less
constexpr double kLongestWait_s = 30.0;

class Jog {
 public:
  Jog(Session& session, const JogRequest& request)
      : session_(session),
        request_(request),
        largest_Nm_(most_torque_Nm(request)),
        push_Nm_(std::min(largest_Nm_, request.push_Nm)) {}

  std::expected<JogMotion, std::string> run() {
    const int asked = request_.angle_rad > 0 ? 1 : -1;
    for (const int direction : {asked, -asked}) {
      motion_.direction = direction;
      if (!wait_until_still() || !push_until_moved() || !settle()) return std::unexpected(stopped_);
      if (motion_.response != Response::none) break;
    }
    if (motion_.response != Response::with_torque) return motion_;
    if (!go_and_return()) return std::unexpected(stopped_);
    motion_.completed = true;
    return motion_;
  }

 private:
  [[nodiscard]] const hal::JointReading& own() const { return session_.readings().joints[request_.joint]; }

  /// One tick with this torque at the joint. False: something is wrong, and nothing gives torque any more.
  [[nodiscard]] bool tick(double torque_Nm) {
    hal::JointCommands commands{};
    const double bounded_Nm = std::clamp(torque_Nm, -largest_Nm_, largest_Nm_);
    commands[request_.joint].torque_Nm = bounded_Nm;
    commands[request_.joint].torque_limit_Nm = std::abs(bounded_Nm);
    session_.tick(commands);
    motion_.peak_torque_Nm = std::max(motion_.peak_torque_Nm, std::abs(bounded_Nm));
    return healthy() && (torque_Nm == 0 || slow());
  }

  [[nodiscard]] bool healthy() {
    const std::string trouble = session_.trouble_with_torque();
    return trouble.empty() || stop(trouble);
  }

  /// Of every joint: limp links move with the one that is pushed.
  [[nodiscard]] bool slow() {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const double velocity_rad_s = session_.readings().joints[joint].velocity_rad_s;
      if (std::abs(velocity_rad_s) <= kRunaway_rad_s) continue;
      return stop(std::string(control_loop::kJointNames[joint]) + " turns too fast");
    }
    return true;
  }

  bool stop(const std::string& reason) {
    stopped_ = reason;
    session_.tick();
    return false;
  }

  /// Sensors and drivers have a moment to speak first.
  bool wait_until_still() {
    const double step_s = session_.tick_s();
    for (double time_s = 0; time_s < kFirstReadings_s; time_s += step_s) session_.tick();
    start_rad_ = joint_angles(session_.readings());
    double still_s = 0;
    for (double time_s = 0; time_s < kLongestWait_s; time_s += step_s) {
      if (!tick(0)) return false;
      const hal::JointValues now_rad = joint_angles(session_.readings());
      still_s += step_s;
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        if (std::abs(now_rad[joint] - start_rad_[joint]) > kStill_rad) still_s = 0;
      }
      if (still_s == 0) start_rad_ = now_rad;
      if (still_s >= kStill_s) return true;
    }
    return stop("the legs do not hang still");
  }

  [[nodiscard]] double moved_rad(std::size_t joint) const {
    return session_.readings().joints[joint].position_rad - start_rad_[joint];
  }

  bool push_until_moved() {
    double torque_Nm = 0;
    for (double time_s = 0; time_s < kTorqueGrowth_s + kAtLargest_s; time_s += session_.tick_s()) {
      torque_Nm = push_Nm_ * std::min(1.0, time_s / kTorqueGrowth_s);
      if (!tick(motion_.direction * torque_Nm)) return false;
      if (moved()) break;
    }
    motion_.breakaway_Nm = torque_Nm;
    motion_.reported_torque_Nm = own().torque_Nm;
    motion_.leg_rad = moved_rad(request_.joint ^ 1U);
    motion_.reached_rad = moved_rad(request_.joint);
    motion_.leg_reached_rad = motion_.leg_rad;
    return true;
  }

  /// Limp links of a leg move when one of its joints does: another encoder counts only while the joint's own
  /// stands still.
  bool moved() {
    const double own_rad = moved_rad(request_.joint);
    if (std::abs(own_rad) > kMoved_rad) {
      motion_.response = own_rad * motion_.direction > 0 ? Response::with_torque : Response::against_torque;
      return true;
    }
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const double other_rad = std::abs(moved_rad(joint));
      if (other_rad <= kMoved_rad || std::abs(own_rad) > kStandsStill * other_rad) continue;
      motion_.response = Response::other;
      motion_.other = joint;
      return true;
    }
    return false;
  }

  /// Without torque, unless the slow motion commands.
  bool settle() { return motion_.response == Response::with_torque || tick(0); }

  bool go_and_return() {
    const double needed_Nm =
        kReserve * motion_.breakaway_Nm * std::max(1.0, std::abs(request_.angle_rad) / kMoved_rad);
    largest_Nm_ = std::min(largest_Nm_, needed_Nm);
    const double held_Nm =
        std::max(2 * motion_.breakaway_Nm, kHeldShare * request_.torque_limit_Nm);  // friction, either way
    encoder_.emplace(request_.joint, held_Nm, request_.supervisor);
    const double start_rad = start_rad_[request_.joint];
    const double to_rad = start_rad + motion_.direction * std::abs(request_.angle_rad);
    if (!travel(own().position_rad, to_rad) || !hold(to_rad) || !travel(to_rad, start_rad)) return false;
    motion_.velocity_factor = integral_rad_ / turned_rad_;
    return tick(0);
  }

  /// Sums up both ways alike, so that a constant error of the velocity cancels.
  bool travel(double from_rad, double to_rad) {
    const double duration_s = std::abs(to_rad - from_rad) / kSpeed_rad_s;
    const double way = to_rad > from_rad ? 1 : -1;
    const double began_rad = own().position_rad;
    for (double time_s = 0; time_s < duration_s; time_s += session_.tick_s()) {
      if (!track(from_rad + way * kSpeed_rad_s * time_s, way * kSpeed_rad_s)) return false;
      integral_rad_ += way * own().velocity_rad_s * session_.tick_s();
    }
    turned_rad_ += way * (own().position_rad - began_rad);
    return true;
  }

  bool hold(double at_rad) {
    for (double time_s = 0; time_s < kHold_s; time_s += session_.tick_s()) {
      if (!track(at_rad, 0)) return false;
    }
    return true;
  }

  bool track(double target_rad, double speed_rad_s) {
    const double behind_rad = target_rad - own().position_rad;
    if (std::abs(behind_rad) > kLost_rad) return stop("the joint does not follow: something holds it");
    const double torque_Nm =
        request_.kp_Nm_rad * behind_rad + request_.kd_Nms_rad * (speed_rad_s - own().velocity_rad_s);
    const std::string trouble = encoder_->trouble(own(), torque_Nm);
    if (!trouble.empty()) return stop(trouble);
    if (!tick(torque_Nm)) return false;
    const double reached_rad = moved_rad(request_.joint);
    if (std::abs(reached_rad) <= std::abs(motion_.reached_rad)) return true;
    motion_.reached_rad = reached_rad;
    motion_.leg_reached_rad = moved_rad(request_.joint ^ 1U);
    return true;
  }

  Session& session_;
  JogRequest request_;
  double largest_Nm_;
  double push_Nm_;
  double turned_rad_ = 0;                // of the position, in the slow motion
  double integral_rad_ = 0;              // of the velocity, meanwhile
  std::optional<EncoderWatch> encoder_;  // in the slow motion
  JogMotion motion_;
  hal::JointValues start_rad_{};
  std::string stopped_;
};

}  // namespace

const char* name(Response response) {
  switch (response) {
    case Response::with_torque:
      return "with_torque";
    case Response::against_torque:
      return "against_torque";
    case Response::other:
      return "other_encoder";
    case Response::none:
      return "none";
  }
  return "";
}

double most_torque_Nm(const JogRequest& request) {
  return std::min(kJogTorqueShare, request.torque_share) * request.torque_limit_Nm;
}

double first_push_Nm(const model::RobotModel& robot, std::size_t joint) {
  const int row = model::kFirstJoint + static_cast<int>(joint);
  double x[model::kStates] = {};
  x[row] = kFirstSwing_rad;
  model::BiasTerms<double> bias;
  robot.bias(x, bias);
  return std::abs(bias.bias[row]) + kFrictionShare * robot.constants.torque_limit_Nm[joint];
}

std::expected<JogMotion, std::string> jog(Session& session, const JogRequest& request) {
  return Jog(session, request).run();
}

}  // namespace stilt::commissioning
