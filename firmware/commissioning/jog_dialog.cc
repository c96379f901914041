#include "firmware/commissioning/jog_dialog.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/commissioning/json_number.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/control_loop/joint_names.h"

namespace stilt::commissioning {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kLargestSighting_deg = 360.0;

constexpr const char* kWhichLink =
    "Which link moved? left thigh, left shin, right thigh, right shin, or none (left and right are the "
    "robot's)";
constexpr const char* kWhichWay = "Which way did it move first? forward or backward";
constexpr const char* kHowFar = "By how many degrees did it turn, about? Empty: not measured";

bool take_link(const std::string& answer, Sighting& seen) {
  if (answer == "none") return true;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (answer == link_name(joint)) seen.link = joint;
  }
  return seen.link.has_value();
}

bool take_way(const std::string& answer, Sighting& seen) {
  seen.way = answer == "backward" ? Way::backward : Way::forward;
  return answer == "backward" || answer == "forward";
}

bool take_angle(const std::string& answer, Sighting& seen) {
  if (answer.empty()) return true;
  double angle_deg = 0;
  const auto read = std::from_chars(answer.data(), answer.data() + answer.size(), angle_deg);
  const bool whole = read.ec == std::errc{} && read.ptr == answer.data() + answer.size();
  if (!whole || !(angle_deg > 0 && angle_deg <= kLargestSighting_deg)) return false;
  seen.angle_rad = angle_deg * kRadians;
  return true;
}

bool may_double(const JogRequest& request) { return request.push_Nm < most_torque_Nm(request); }

/// What a person needs to know for the answer: "none" may bring more torque.
std::string which_link(const JogRequest& request, const JogMotion& motion) {
  if (motion.response != Response::none) return kWhichLink;
  char text[120];
  std::snprintf(text, sizeof text, ". No encoder moved with %.1f Nm either way%s", motion.breakaway_Nm,
                may_double(request) ? "; none doubles the torque" : "");
  return kWhichLink + std::string(text);
}

std::expected<Sighting, CommandFailure> ask_all(Session& session, Person& person, const JogRequest& request,
                                                const JogMotion& motion) {
  Sighting seen;
  const auto put = [&](const std::string& question, bool (*take)(const std::string&, Sighting&)) {
    return ask(session, person, question,
               [take, &seen](const std::string& answer) { return take(answer, seen); });
  };
  if (const auto link = put(which_link(request, motion), take_link); !link)
    return std::unexpected(link.error());
  if (!seen.link) return seen;
  if (const auto way = put(kWhichWay, take_way); !way) return std::unexpected(way.error());
  if (!motion.completed) return seen;
  if (const auto far = put(kHowFar, take_angle); !far) return std::unexpected(far.error());
  return seen;
}

std::expected<JogReport, CommandFailure> run(Session& session, JogRequest request,
                                             const configuration::DriverParameters& driver, Person& person) {
  if (const auto up = session.bring_up(); !up) return std::unexpected(CommandFailure{up.error(), false});
  for (double peak_Nm = 0;; request.push_Nm *= 2) {
    auto motion = jog(session, request);
    if (!motion) return std::unexpected(CommandFailure{motion.error(), false});
    peak_Nm = motion->peak_torque_Nm = std::max(peak_Nm, motion->peak_torque_Nm);
    const auto seen = ask_all(session, person, request, *motion);
    if (!seen) return std::unexpected(seen.error());
    if (motion->response == Response::none && !seen->link && may_double(request)) continue;
    return JogReport{request, *motion, *seen, judge(request.joint, *motion, *seen, driver)};
  }
}

std::string measured_text(const JogReport& report) {
  const JogMotion& motion = report.motion;
  if (motion.response == Response::none) return "";
  char text[160];
  std::snprintf(text, sizeof text, "moved at %.2f Nm, went %.3f rad by its encoder, peak %.2f Nm\n",
                motion.breakaway_Nm, motion.reached_rad, motion.peak_torque_Nm);
  const bool other_way = motion.direction * report.request.angle_rad < 0;
  return (other_way ? "no encoder moved the way that was asked for, so it went the other way\n" : "") +
         std::string(text);
}

}  // namespace

std::expected<JogReport, CommandFailure> jog_and_ask(Session& session, const JogRequest& request,
                                                     const configuration::DriverParameters& driver,
                                                     Person& person) {
  auto report = run(session, request, driver, person);
  session.disable();
  return report;
}

std::string to_text(const JogReport& report) {
  return measured_text(report) + report.verdict.sentence + '\n';
}

std::string to_json(const JogReport& report) {
  const JogMotion& motion = report.motion;
  nlohmann::ordered_json json;
  json["good"] = report.verdict.finding == Finding::correct;
  json["joint"] = control_loop::kJointNames[report.request.joint];
  json["angle_rad"] = report.request.angle_rad;
  json["finding"] = name(report.verdict.finding);
  json["sentence"] = report.verdict.sentence;
  json["response"] = name(motion.response);
  json["other_encoder"] =
      motion.other ? nlohmann::ordered_json(control_loop::kJointNames[*motion.other]) : nullptr;
  json["torque_direction"] = motion.direction;
  json["breakaway_Nm"] = motion.breakaway_Nm;
  json["reported_torque_Nm"] = json_number(motion.reported_torque_Nm);
  json["leg_rad"] = motion.leg_rad;
  json["reached_rad"] = motion.reached_rad;
  json["leg_reached_rad"] = motion.leg_reached_rad;
  json["velocity_factor"] = json_number(motion.velocity_factor);
  json["peak_torque_Nm"] = motion.peak_torque_Nm;
  json["completed"] = motion.completed;
  json["seen_link"] = report.seen.link ? nlohmann::ordered_json(link_name(*report.seen.link)) : nullptr;
  json["seen_way"] = !report.seen.link                  ? nlohmann::ordered_json(nullptr)
                     : report.seen.way == Way::backward ? "backward"
                                                        : "forward";
  json["seen_angle_rad"] = report.seen.angle_rad ? nlohmann::ordered_json(*report.seen.angle_rad) : nullptr;
  return json_text(json);
}

}  // namespace stilt::commissioning
