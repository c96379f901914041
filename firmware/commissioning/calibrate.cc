#include "firmware/commissioning/calibrate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/wiring_verdict.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

using control_loop::kJointNames;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMeasured_s = 0.5;
constexpr double kStill_rad = 0.02;   // while it is measured, by hand
constexpr double kRocked_rad = 0.03;  // standard deviation
constexpr std::size_t kMostSamples = 30'000;

std::expected<void, CommandFailure> failure(const std::string& sentence) {
  return std::unexpected(CommandFailure{sentence, false});
}

/// Means over a moment, and how much the joints moved meanwhile.
struct Measured {
  Angles joint_rad{};
  double pitch_rad = 0;
  Angles motion_rad{};

  [[nodiscard]] double leg_motion_rad(std::size_t joint) const {
    return std::max(motion_rad[joint], motion_rad[joint ^ 1U]);
  }
};

class Calibration {
 public:
  Calibration(Session& session, const CalibrationRequest& request, Person& person)
      : session_(session), request_(request), person_(person) {
    report_.reference = request.reference;
  }

  std::expected<CalibrationReport, CommandFailure> run() {
    if (const auto up = session_.bring_up(); !up) return std::unexpected(CommandFailure{up.error(), false});
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (const auto done = calibrate(joint); !done) return std::unexpected(done.error());
    }
    if (std::ranges::all_of(report_.joints, &JointCalibration::good)) {
      if (const auto done = try_torso(); !done) return std::unexpected(done.error());
    }
    if (report_.good()) report_.values = new_values(request_.hardware, report_.joints, report_.torso);
    return report_;
  }

 private:
  std::expected<void, CommandFailure> calibrate(std::size_t joint) {
    const JointPoses poses =
        joint_poses(request_.reference, request_.minimum_rad[joint], request_.maximum_rad[joint]);
    const bool stops = request_.reference == Reference::stops;
    const std::string first = stops ? "forward to its end stop" : "to its alignment mark, in line";
    Measured at_first, at_second;
    if (auto done = move(joint, first + angle(joint, poses.first_rad), at_first); !done) return done;
    const std::string second = stops ? "backward to its other end stop" : "backward, at least";
    if (auto done = move(joint, second + angle(joint, poses.second_rad), at_second); !done) return done;
    const auto& hardware = request_.hardware;
    report_.joints[joint] =
        calibrate_joint(joint, poses, before_wiring(at_first.joint_rad), before_wiring(at_second.joint_rad),
                        hardware.joint[joint], (joint % 2 == 0 ? hardware.hip : hardware.knee).ratio);
    return {};
  }

  static std::string angle(std::size_t joint, double angle_rad) {
    return formatted(" (%s at %.3f rad, %.1f degrees)", kJointNames[joint], angle_rad, angle_rad * kDegrees);
  }

  /// Asks for a pose until it is held still.
  std::expected<void, CommandFailure> move(std::size_t joint, const std::string& where, Measured& measured) {
    const std::string rest = joint % 2 == 0 ? "the leg straight" : "the thigh still";
    const std::string question = std::string("Hold ") + rest + ", and move the " + link_name(joint) + " " +
                                 where + ". Press Enter while it is held there";
    return pose(
        question, [joint](const Measured& all) { return all.leg_motion_rad(joint); }, measured);
  }

  /// @param motion_rad  of what must be still
  template <class Motion>
  std::expected<void, CommandFailure> pose(const std::string& question, const Motion& motion_rad,
                                           Measured& measured) {
    while (true) {
      if (auto put = ask(session_, person_, question, [](const auto& answer) { return answer.empty(); });
          !put) {
        return put;
      }
      measured = measure();
      if (const std::string trouble = session_.trouble(); !trouble.empty()) return failure(trouble);
      if (motion_rad(measured) < kStill_rad) return {};
      if (!person_.patient()) {
        return failure(formatted("a joint moved by %.3f rad while it was measured; hold the robot still",
                                 motion_rad(measured)));
      }
    }
  }

  Measured measure() {
    Measured measured;
    Angles least, most;
    least.fill(INFINITY);
    most.fill(-INFINITY);
    const auto count = static_cast<int>(std::lround(kMeasured_s / session_.tick_s()));
    for (int i = 0; i < count; ++i) {
      session_.tick();
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        const double now_rad = session_.readings().joints[joint].position_rad;
        measured.joint_rad[joint] += now_rad / count;
        least[joint] = std::min(least[joint], now_rad);
        most[joint] = std::max(most[joint], now_rad);
        measured.motion_rad[joint] = most[joint] - least[joint];
      }
      measured.pitch_rad += session_.readings().base.pitch_rad / count;
    }
    return measured;
  }

  /// u of calibration.h, from angles by the configuration.
  [[nodiscard]] Angles before_wiring(const Angles& configured_rad) const {
    Angles turned_rad;
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const configuration::JointParameters& place = request_.hardware.joint[joint];
      turned_rad[joint] = (place.reversed ? -1 : 1) * (configured_rad[joint] - place.offset_rad);
    }
    return turned_rad;
  }

  [[nodiscard]] Angles calibrated(const Angles& configured_rad) const {
    Angles angles_rad = before_wiring(configured_rad);
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const JointCalibration& result = report_.joints[joint];
      angles_rad[joint] = (result.reversed ? -1 : 1) * angles_rad[joint] + result.offset_rad;
    }
    return angles_rad;
  }

  std::expected<void, CommandFailure> try_torso() {
    Measured rest;
    const std::string question =
        "Release the legs, and help them to hang plumb; leave the torso alone. Press Enter when all is at "
        "rest";
    const auto both_legs = [](const Measured& all) {
      return std::max(all.leg_motion_rad(0), all.leg_motion_rad(2));
    };
    if (auto done = pose(question, both_legs, rest); !done) {
      return done;
    }
    TorsoMotion motion{.rest_pitch_rad = rest.pitch_rad, .rest_rad = calibrated(rest.joint_rad)};
    if (auto done = rock(motion); !done) return done;
    report_.torso = calibrate_torso(motion);
    return {};
  }

  /// The left hip says how the torso turns, since its thigh does not.
  std::expected<void, CommandFailure> rock(TorsoMotion& motion) {
    const std::string question =
        "Hold the left thigh still with one hand. With the other rock the torso forward and backward three "
        "times, by 10 degrees or more. Press Enter";
    while (true) {
      std::vector<double> torso_rad, pitch_rad, integral_rad;
      const auto record = [&] {
        if (torso_rad.size() == kMostSamples) return;
        const hal::BaseReading& base = session_.readings().base;
        Angles now_rad;
        for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
          now_rad[joint] = session_.readings().joints[joint].position_rad;
        }
        torso_rad.push_back(-calibrated(now_rad)[0]);
        pitch_rad.push_back(base.pitch_rad);
        const double last_rad = integral_rad.empty() ? 0 : integral_rad.back();
        integral_rad.push_back(last_rad + base.pitch_rate_rad_s * session_.tick_s());
      };
      if (auto put = ask(
              session_, person_, question, [](const auto& answer) { return answer.empty(); }, record);
          !put) {
        return put;
      }
      if (const std::string trouble = session_.trouble(); !trouble.empty()) return failure(trouble);
      motion.pitch = fit_lag(torso_rad, pitch_rad, session_.tick_s());
      motion.rate = fit_lag(torso_rad, integral_rad, session_.tick_s());
      if (motion.pitch.reference_spread > kRocked_rad) return {};
      if (!person_.patient()) return failure("the torso did not rock against the left thigh");
    }
  }

  Session& session_;
  const CalibrationRequest& request_;
  Person& person_;
  CalibrationReport report_;
};

}  // namespace

bool CalibrationReport::good() const {
  return std::ranges::all_of(joints, &JointCalibration::good) && torso.good();
}

std::expected<CalibrationReport, CommandFailure> calibrate(Session& session,
                                                           const CalibrationRequest& request,
                                                           Person& person) {
  auto report = Calibration(session, request, person).run();
  session.disable();
  return report;
}

}  // namespace stilt::commissioning
