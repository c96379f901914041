#include "host_tools/simulation/closed_loop/scenario.h"

#include <stdexcept>
#include <string>

#include "host_tools/simulation/plant/number.h"

namespace stilt::simulation {
namespace {

constexpr double kLargestForce_N = 10000.0;
constexpr double kLargestSpeed_m_s = 5.0;
/// Pushes and commands count from this much before their time, so that rounding of a tick cannot delay them.
constexpr double kTimeSlack_s = 1e-9;

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw std::invalid_argument(std::string(option) + " " + std::string(text) + ": " + std::string(expected));
}

/// Splits `text` at the first `separator`. Sets `rest` to the text after it and `found` to whether it occurs.
std::string_view cut(std::string_view text, char separator, std::string_view& rest, bool& found) {
  const std::size_t at = text.find(separator);
  found = at != std::string_view::npos;
  rest = found ? text.substr(at + 1) : std::string_view{};
  return text.substr(0, at);
}

bool overlap(const Push& a, const Push& b) {
  return a.start_s < b.start_s + b.duration_s && b.start_s < a.start_s + a.duration_s;
}

}  // namespace

Push parse_push(std::string_view text) {
  constexpr std::string_view kExpected =
      "expected N@START+DURATION[@hip|torso] with START >= 0 and DURATION > 0 in seconds and N within 10000 "
      "N "
      "either way, for example 40@10+1";
  std::string_view after_force, after_start, point;
  bool has_time = false, has_duration = false, has_point = false;
  const auto force = parse_number(cut(text, '@', after_force, has_time));
  // A plus sign can also belong to an exponent; the time itself never needs one.
  const auto start = parse_number(cut(after_force, '+', after_start, has_duration));
  const auto duration = parse_number(cut(after_start, '@', point, has_point));
  if (!force || !start || !duration || *start < 0.0 || *duration <= 0.0 || *force > kLargestForce_N ||
      *force < -kLargestForce_N) {
    refuse("--push", text, kExpected);
  }
  if (has_point && point != "hip" && point != "torso") refuse("--push", text, kExpected);
  return {*force, *start, *duration, point == "torso" ? PushPoint::torso : PushPoint::hip};
}

TimedCommand parse_timed_command(std::string_view text, double usual_speed_m_s) {
  constexpr std::string_view kExpected =
      "expected GAIT[:SPEED]@START with a gait out of stand, step, walk, a speed within 5 m/s either way and "
      "START >= 0 in seconds, for example walk:0.5@5";
  std::string_view start_text, speed_text;
  bool has_start = false, has_speed = false;
  const std::string_view what = cut(text, '@', start_text, has_start);
  const std::string_view gait = cut(what, ':', speed_text, has_speed);
  const auto start = parse_number(start_text);
  const auto speed =
      has_speed ? parse_number(speed_text) : std::optional(gait == "walk" ? usual_speed_m_s : 0.0);
  const bool known = gait == "stand" || gait == "step" || gait == "walk";
  if (!known || !start || !speed || *start < 0.0 || *speed > kLargestSpeed_m_s ||
      *speed < -kLargestSpeed_m_s) {
    refuse("--then", text, kExpected);
  }
  return {*start, {parse_gait(gait), *speed}};
}

gait::GaitKind parse_gait(std::string_view text) {
  if (text == "stand") return gait::GaitKind::stand;
  if (text == "step") return gait::GaitKind::step;
  if (text == "walk") return gait::GaitKind::walk;
  refuse("--gait", text, "no such gait; known are stand, step, walk");
}

const char* gait_name(gait::GaitKind kind) {
  constexpr const char* kNames[] = {"stand", "step", "walk"};
  return kNames[static_cast<int>(kind)];
}

bool parse_knows_truth(std::string_view text) {
  if (text != "estimated" && text != "truth") {
    refuse("--state", text, "no such source of the state; known are estimated, truth");
  }
  return text == "truth";
}

void check_pushes(const std::vector<Push>& pushes, double tick_s) {
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (pushes[i].duration_s < tick_s - kTimeSlack_s) {
      throw std::invalid_argument("--push: " + number_text(pushes[i].duration_s) +
                                  " s are shorter than a tick, " + number_text(tick_s) +
                                  " s; a push begins and ends with a tick");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (pushes[i].point == pushes[j].point || !overlap(pushes[i], pushes[j])) continue;
      throw std::invalid_argument("--push: two pushes that overlap in time, from " +
                                  number_text(pushes[j].start_s) + " s and from " +
                                  number_text(pushes[i].start_s) + " s, must act at the same point");
    }
  }
}

ActingPush push_at(const std::vector<Push>& pushes, double time_s) {
  ActingPush acting;
  for (const Push& push : pushes) {
    const double elapsed_s = time_s - push.start_s + kTimeSlack_s;
    if (elapsed_s < 0.0 || elapsed_s >= push.duration_s) continue;
    acting.force_N += push.force_N;
    acting.point = push.point;
  }
  return acting;
}

gait::GaitCommand command_at(const std::vector<TimedCommand>& commands, double time_s) {
  gait::GaitCommand current;
  for (const TimedCommand& timed : commands) {
    if (timed.start_s <= time_s + kTimeSlack_s) current = timed.command;
  }
  return current;
}

}  // namespace stilt::simulation
