#include "firmware/commissioning/identify.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "firmware/commissioning/encoder_watch.h"
#include "firmware/commissioning/formatted.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

using control_loop::kJointNames;

constexpr double kKnee_rad = 0.3;       // while other joints move
constexpr double kHipRange_rad = 0.6;   // either way
constexpr double kKneeRange_rad = 1.8;  // from near straight
constexpr double kFromStop_rad = 0.15;
constexpr double kApproach_rad_s = 0.4;
constexpr double kSettle_s = 0.5;
constexpr double kSlowRamp_s = 4.5;  // over the range
constexpr double kFastRamp_s = 1.5;
constexpr double kSweep_s = 12.0;
constexpr double kSweepFrom_hz = 0.4, kSweepTo_hz = 2.0;
constexpr double kSweep_rad = 0.25;     // largest amplitude
constexpr double kSweep_rad_s2 = 15.0;  // largest acceleration
constexpr double kDamping_s = 0.08;     // kd over kp
constexpr double kLost_rad = 0.6;       // behind the motion
constexpr double kBeyondTravel_rad = 0.05;
constexpr double kRunaway_rad_s = 5.0;
constexpr double kFirstReadings_s = 0.3;

/// Where a joint shall be.
struct Target {
  double angle_rad = 0;
  double rate_rad_s = 0;
};

/// Part of the travel, away from the stops.
struct Range {
  double low_rad, high_rad;
  [[nodiscard]] double middle_rad() const { return 0.5 * (low_rad + high_rad); }
  [[nodiscard]] double half_rad() const { return 0.5 * (high_rad - low_rad); }
};

class Exciter {
 public:
  Exciter(Session& session, const IdentificationRequest& request)
      : session_(session), request_(request), constants_(request.robot->constants) {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      encoders_.emplace_back(joint, kHeldShare * constants_.torque_limit_Nm[joint], request.supervisor);
    }
  }

  std::expected<Excitation, std::string> run() {
    if (const auto up = session_.bring_up(); !up) return std::unexpected(up.error());
    for (double time_s = 0; time_s < kFirstReadings_s; time_s += session_.tick_s()) session_.tick();
    if (!hold_from_here() || !spread()) return std::unexpected(stopped_);
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (!excite(joint)) return std::unexpected(stopped_);
    }
    result_.period_s = session_.tick_s();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Range range(std::size_t joint) const {
    const double least_rad = constants_.position_min_rad[joint] + kFromStop_rad;
    const double most_rad = constants_.position_max_rad[joint] - kFromStop_rad;
    if (joint % 2 == 1) return {least_rad, std::min(most_rad, least_rad + kKneeRange_rad)};
    return {std::max(least_rad, -kHipRange_rad), std::min(most_rad, kHipRange_rad)};
  }

  bool stop(const std::string& reason) {
    stopped_ = reason;
    session_.tick();
    return false;
  }

  bool hold_from_here() {
    const std::string trouble = session_.trouble_with_torque();
    if (!trouble.empty()) return stop(trouble);
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      targets_[joint] = {session_.readings().joints[joint].position_rad, 0};
    }
    return true;
  }

  /// The pose in which joints wait.
  [[nodiscard]] double waiting_rad(std::size_t joint) const {
    const double wanted_rad = joint % 2 == 1 ? kKnee_rad : 0.0;
    return std::clamp(wanted_rad, range(joint).low_rad, range(joint).high_rad);
  }

  bool spread() {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (!approach(joint, waiting_rad(joint))) return false;
    }
    return true;
  }

  bool approach(std::size_t joint, double to_rad) {
    const double from_rad = targets_[joint].angle_rad;
    return ramp(joint, to_rad, std::abs(to_rad - from_rad) / kApproach_rad_s) && wait(joint);
  }

  bool wait(std::size_t joint) {
    return follow(joint, kSettle_s,
                  [at_rad = targets_[joint].angle_rad](double) { return Target{at_rad, 0}; });
  }

  bool ramp(std::size_t joint, double to_rad, double duration_s) {
    const double from_rad = targets_[joint].angle_rad;
    if (duration_s <= 0) return true;
    const double rate_rad_s = (to_rad - from_rad) / duration_s;
    return follow(joint, duration_s,
                  [=](double time_s) { return Target{from_rad + rate_rad_s * time_s, rate_rad_s}; });
  }

  /// To both ends and back, each way of the whole range in this time.
  bool ramps(std::size_t joint, double whole_way_s) {
    const Range travel = range(joint);
    return ramp(joint, travel.high_rad, 0.5 * whole_way_s) && ramp(joint, travel.low_rad, whole_way_s) &&
           ramp(joint, travel.middle_rad(), 0.5 * whole_way_s);
  }

  /// A sine whose frequency grows exponentially, its acceleration bounded.
  bool sweep(std::size_t joint) {
    const Range travel = range(joint);
    const double growth = std::log(kSweepTo_hz / kSweepFrom_hz) / kSweep_s;
    return follow(joint, kSweep_s, [=](double time_s) {
      const double omega = 2 * std::numbers::pi * kSweepFrom_hz * std::exp(growth * time_s);
      const double phase = (omega - 2 * std::numbers::pi * kSweepFrom_hz) / growth;
      const double amplitude_rad = std::min({kSweep_rad, travel.half_rad(), kSweep_rad_s2 / (omega * omega)});
      return Target{travel.middle_rad() + amplitude_rad * std::sin(phase),
                    amplitude_rad * omega * std::cos(phase)};
    });
  }

  bool excite(std::size_t joint) {
    if (!approach(joint, range(joint).middle_rad())) return false;
    recorded_ = &result_.records[joint];
    const bool done =
        ramps(joint, kSlowRamp_s) && ramps(joint, kFastRamp_s) && ramps(joint, kFastRamp_s) && sweep(joint);
    recorded_ = nullptr;
    return done && approach(joint, waiting_rad(joint));
  }

  template <class Path>
  bool follow(std::size_t joint, double duration_s, const Path& path) {
    for (double time_s = 0; time_s < duration_s; time_s += session_.tick_s()) {
      targets_[joint] = path(time_s);
      moving_ = joint;
      if (!tick()) return false;
    }
    targets_[joint] = {path(duration_s).angle_rad, 0};
    return true;
  }

  /// Reads, looks, and commands all joints.
  bool tick() {
    session_.begin_tick();
    record();
    if (!within_limits()) {
      session_.command();
      session_.end_tick();
      return false;
    }
    hal::JointCommands commands{};
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const double limit_Nm = request_.torque_share * constants_.torque_limit_Nm[joint];
      const double torque_Nm = std::clamp(wanted_Nm(joint), -limit_Nm, limit_Nm);
      commands[joint].torque_Nm = torque_Nm;
      commands[joint].torque_limit_Nm = limit_Nm;
      result_.peak_torque_Nm[joint] = std::max(result_.peak_torque_Nm[joint], std::abs(torque_Nm));
      before_last_Nm_[joint] = last_Nm_[joint];
      last_Nm_[joint] = torque_Nm;
    }
    session_.command(commands);
    session_.end_tick();
    return true;
  }

  [[nodiscard]] double wanted_Nm(std::size_t joint) const {
    const hal::JointReading& reading = session_.readings().joints[joint];
    return request_.kp_Nm_rad * (targets_[joint].angle_rad - reading.position_rad) +
           kDamping_s * request_.kp_Nm_rad * (targets_[joint].rate_rad_s - reading.velocity_rad_s);
  }

  /// A reading is of the moment at which the command of the tick before it arrived. Half of that command's
  /// tick and half of the one before are beside it.
  void record() {
    if (recorded_ == nullptr) return;
    const hal::RobotReadings& readings = session_.readings();
    recorded_->torque_Nm.push_back(0.5 * (last_Nm_[moving_] + before_last_Nm_[moving_]));
    recorded_->angle_rad[0].push_back(readings.base.pitch_rad);
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      recorded_->angle_rad[1 + joint].push_back(readings.joints[joint].position_rad);
    }
  }

  bool within_limits() {
    stopped_ = session_.trouble_with_torque();
    if (stopped_.empty()) stopped_ = session_.torso_trouble();
    if (!stopped_.empty()) return false;
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const hal::JointReading& reading = session_.readings().joints[joint];
      const char* name = kJointNames[joint];
      const std::string encoder = encoders_[joint].trouble(reading, wanted_Nm(joint));
      const double below_rad = constants_.position_min_rad[joint] - reading.position_rad;
      const double above_rad = reading.position_rad - constants_.position_max_rad[joint];
      if (std::max(below_rad, above_rad) > kBeyondTravel_rad) {
        stopped_ = formatted("%s is at %.2f rad, beyond its travel", name, reading.position_rad);
      } else if (!(std::abs(reading.velocity_rad_s) < kRunaway_rad_s)) {
        stopped_ = formatted("%s is too fast", name);
      } else if (std::abs(targets_[joint].angle_rad - reading.position_rad) > kLost_rad) {
        stopped_ = formatted("%s does not follow: something holds it, or the torque limit is too low", name);
      } else if (!encoder.empty()) {
        stopped_ = encoder;
      }
    }
    return stopped_.empty();
  }

  Session& session_;
  const IdentificationRequest& request_;
  const model::RobotConstants& constants_;
  std::vector<EncoderWatch> encoders_;
  std::array<Target, hal::kJoints> targets_;
  std::size_t moving_ = 0;
  Excitation result_;
  DriveRecord* recorded_ = nullptr;
  hal::JointValues last_Nm_{}, before_last_Nm_{};
  std::string stopped_;
};

}  // namespace

std::expected<Excitation, std::string> excite(Session& session, const IdentificationRequest& request) {
  auto excitation = Exciter(session, request).run();
  session.disable();
  return excitation;
}

IdentificationReport identified(const IdentificationRequest& request, const Excitation& excitation) {
  IdentificationReport report;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    report.drives[joint] =
        fit_drive(*request.robot, joint, std::span(&excitation.records[joint], 1), excitation.period_s);
  }
  report.peak_torque_Nm = excitation.peak_torque_Nm;
  judge(request, report);
  return report;
}

std::expected<IdentificationReport, std::string> identify(Session& session,
                                                          const IdentificationRequest& request) {
  const auto excitation = excite(session, request);
  if (!excitation) return std::unexpected(excitation.error());
  return identified(request, *excitation);
}

}  // namespace stilt::commissioning
