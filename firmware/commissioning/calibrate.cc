#include "firmware/commissioning/calibrate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <utility>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/wiring_verdict.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

using control_loop::kJointNames;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMeasured_s = 0.5;
constexpr double kStill_rad = 0.02;   // while it is measured, by hand
constexpr double kRocked_rad = 0.03;  // standard deviation
constexpr double kKept_s = 30.0;      // the newest of the rocking
constexpr double kLargestTurn_deg = 180.0;

std::expected<void, CommandFailure> failure(const std::string& sentence) {
  return std::unexpected(CommandFailure{sentence, false});
}

/// Means over a moment, and how much the joints moved meanwhile.
struct Measured {
  hal::JointValues joint_rad{};
  double pitch_rad = 0;
  bool pitch_silent = false;
  hal::JointValues motion_rad{};

  [[nodiscard]] double leg_motion_rad(std::size_t joint) const {
    return std::max(motion_rad[joint], motion_rad[joint ^ 1U]);
  }
};

/// A moment of a torso that rocks.
struct Rocked {
  double torso_rad, pitch_rad, pitch_rate_rad_s;
};

class PoseReader {
 public:
  PoseReader(Session& session, const CalibrationRequest& request, Person& person)
      : session_(session), request_(request), person_(person) {}

  std::expected<CalibrationReadings, CommandFailure> run() {
    if (const auto up = session_.bring_up(); !up) return std::unexpected(CommandFailure{up.error(), false});
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (const auto done = calibrate(joint); !done) return std::unexpected(done.error());
    }
    if (std::ranges::all_of(readings_.joints, &JointCalibration::good)) {
      if (const auto done = try_torso(); !done) return std::unexpected(done.error());
    }
    return std::move(readings_);
  }

 private:
  std::expected<void, CommandFailure> calibrate(std::size_t joint) {
    JointPoses poses =
        joint_poses(request_.reference, request_.minimum_rad[joint], request_.maximum_rad[joint]);
    const bool stops = request_.reference == Reference::stops;
    const std::string first = stops ? "forward to its end stop" : "to its alignment mark, in line";
    Measured at_first, at_second;
    if (auto done = move(joint, first + angle(joint, poses.first_rad), at_first); !done) return done;
    const std::string second = stops ? "backward to its other end stop" : "backward, at least";
    if (auto done = move(joint, second + angle(joint, poses.second_rad), at_second); !done) return done;
    if (!stops) {
      if (auto done = ask_turn(joint, poses); !done) return done;
    }
    const auto& hardware = request_.hardware;
    readings_.joints[joint] =
        calibrate_joint(joint, poses, before_wiring(at_first.joint_rad), before_wiring(at_second.joint_rad),
                        hardware.joint[joint], configuration::driver_of(hardware, joint).ratio);
    return {};
  }

  /// How far the joint turned from its mark, where the person has measured it.
  std::expected<void, CommandFailure> ask_turn(std::size_t joint, JointPoses& poses) {
    const auto take = [&poses](const std::string& answer) {
      if (answer.empty()) return true;
      double turned_deg = 0;
      const auto read = std::from_chars(answer.data(), answer.data() + answer.size(), turned_deg);
      const bool whole = read.ec == std::errc{} && read.ptr == answer.data() + answer.size();
      if (!whole || !(turned_deg > 0 && turned_deg <= kLargestTurn_deg)) return false;
      poses.second_rad = poses.first_rad + turned_deg / kDegrees;
      poses.second_measured = true;
      return true;
    };
    return ask(session_, person_,
               std::string("By how many degrees did the ") + link_name(joint) +
                   " turn from its mark, by an inclinometer or a square? Empty: not measured",
               take);
  }

  static std::string angle(std::size_t joint, double angle_rad) {
    return formatted(" (%s at %.3f rad, %.1f degrees)", kJointNames[joint], angle_rad, angle_rad * kDegrees);
  }

  /// Asks for a pose until it is held still.
  std::expected<void, CommandFailure> move(std::size_t joint, const std::string& where, Measured& measured) {
    const std::string rest = joint % 2 == 0 ? "the leg straight" : "the thigh still";
    const std::string question = std::string("Hold ") + rest + ", and move the " + link_name(joint) + " " +
                                 where + ". Press Enter while it is held there";
    return pose(question, [joint](const Measured& all) { return all.leg_motion_rad(joint); }, measured);
  }

  /// @param motion_rad  of what must be still
  template <class Motion>
  std::expected<void, CommandFailure> pose(const std::string& question, const Motion& motion_rad,
                                           Measured& measured) {
    std::string reason;
    while (true) {
      if (auto put = press_enter(reason + question); !put) return put;
      measured = measure();
      if (const std::string trouble = session_.trouble(); !trouble.empty()) return failure(trouble);
      if (motion_rad(measured) < kStill_rad) return {};
      const std::string moved = formatted(
          "a joint moved by %.3f rad while it was measured; hold the robot still", motion_rad(measured));
      if (!person_.patient()) return failure(moved);
      reason = moved + ".\n";
    }
  }

  std::expected<void, CommandFailure> press_enter(const std::string& question,
                                                  const std::function<void()>& each_tick = {}) {
    const auto is_enter = [](const std::string& answer) { return answer.empty(); };
    return ask(session_, person_, question, is_enter, each_tick);
  }

  Measured measure() {
    Measured measured;
    hal::JointValues least, most;
    least.fill(INFINITY);
    most.fill(-INFINITY);
    const auto count = static_cast<int>(std::lround(kMeasured_s / session_.tick_s()));
    for (int i = 0; i < count; ++i) {
      session_.tick();
      const hal::JointValues now_rad = joint_angles(session_.readings());
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        measured.joint_rad[joint] += now_rad[joint] / count;
        least[joint] = std::min(least[joint], now_rad[joint]);
        most[joint] = std::max(most[joint], now_rad[joint]);
        measured.motion_rad[joint] = most[joint] - least[joint];
      }
      measured.pitch_silent = measured.pitch_silent || !session_.torso_trouble().empty();
      measured.pitch_rad += session_.readings().base.pitch_rad / count;
    }
    return measured;
  }

  /// u of calibration.h, from angles by the configuration.
  [[nodiscard]] hal::JointValues before_wiring(const hal::JointValues& configured_rad) const {
    hal::JointValues turned_rad;
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const configuration::JointParameters& place = request_.hardware.joint[joint];
      turned_rad[joint] = (place.reversed ? -1 : 1) * (configured_rad[joint] - place.offset_rad);
    }
    return turned_rad;
  }

  [[nodiscard]] hal::JointValues calibrated(const hal::JointValues& configured_rad) const {
    hal::JointValues angles_rad = before_wiring(configured_rad);
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      const JointCalibration& result = readings_.joints[joint];
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
    TorsoReadings& torso = readings_.torso.emplace();
    torso.rest_pitch_rad = rest.pitch_rad;
    torso.rest_rad = calibrated(rest.joint_rad);
    torso.silent = rest.pitch_silent;
    torso.period_s = session_.tick_s();
    return torso.silent ? std::expected<void, CommandFailure>() : rock(torso);
  }

  /// The left hip shows how the torso turns, since its thigh does not.
  std::expected<void, CommandFailure> rock(TorsoReadings& torso) {
    const std::string question =
        "Hold the left thigh still with one hand. With the other rock the torso forward and backward three "
        "times, by 10 degrees or more. Press Enter";
    const auto most = static_cast<std::size_t>(std::lround(kKept_s / session_.tick_s()));
    std::string reason;
    while (true) {
      std::deque<Rocked> rocked;
      const auto record = [&] {
        const hal::BaseReading& base = session_.readings().base;
        const double torso_rad = -calibrated(joint_angles(session_.readings()))[0];
        rocked.push_back({torso_rad, base.pitch_rad, base.pitch_rate_rad_s});
        if (rocked.size() > most) rocked.pop_front();
        torso.silent = torso.silent || !session_.torso_trouble().empty();
      };
      if (auto put = press_enter(reason + question, record); !put) return put;
      if (const std::string trouble = session_.trouble(); !trouble.empty()) return failure(trouble);
      keep(rocked, torso);
      if (torso.silent || spread(torso.torso_rad) > kRocked_rad) return {};
      const std::string unmoved = "the torso did not rock against the left thigh";
      if (!person_.patient()) return failure(unmoved);
      reason = unmoved + ".\n";
    }
  }

  static void keep(const std::deque<Rocked>& rocked, TorsoReadings& torso) {
    torso.torso_rad.clear();
    torso.pitch_rad.clear();
    torso.pitch_rate_rad_s.clear();
    for (const Rocked& moment : rocked) {
      torso.torso_rad.push_back(moment.torso_rad);
      torso.pitch_rad.push_back(moment.pitch_rad);
      torso.pitch_rate_rad_s.push_back(moment.pitch_rate_rad_s);
    }
  }

  Session& session_;
  const CalibrationRequest& request_;
  Person& person_;
  CalibrationReadings readings_;
};

}  // namespace

bool CalibrationReport::good() const {
  return std::ranges::all_of(joints, &JointCalibration::good) && torso.good();
}

std::expected<CalibrationReadings, CommandFailure> read_poses(Session& session,
                                                              const CalibrationRequest& request,
                                                              Person& person) {
  auto readings = PoseReader(session, request, person).run();
  session.disable();
  return readings;
}

CalibrationReport calibrated(const CalibrationRequest& request, const CalibrationReadings& readings) {
  CalibrationReport report{
      .reference = request.reference, .joints = readings.joints, .torso = {}, .values = {}};
  const configuration::HardwareParameters& hardware = request.hardware;
  if (readings.torso) {
    report.torso = calibrate_torso(torso_motion(*readings.torso), hardware.torso_sensor);
  }
  if (report.good()) report.values = new_values(hardware, report.joints, report.torso);
  return report;
}

std::expected<CalibrationReport, CommandFailure> calibrate(Session& session,
                                                           const CalibrationRequest& request,
                                                           Person& person) {
  const auto readings = read_poses(session, request, person);
  if (!readings) return std::unexpected(readings.error());
  return calibrated(request, *readings);
}

}  // namespace stilt::commissioning
