#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/commissioning/calibration.h"
#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/commissioning/session.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/program/interrupt_report.h"
#include "firmware/program/self_test.h"

namespace stilt::program {
namespace {

using commissioning::formatted;
using control_loop::kJointNames;

/// Of the periods of the test: a thread that starts late, and a period left out here and there.
constexpr double kFewestSolves = 0.9;
/// Of the solves: every one works on a machine that computes right.
constexpr double kFailedSolves = 0.01;

double share(long long part, long long whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

/// "-" for what is not reported.
std::string measured(double value, const char* unit) {
  return std::isfinite(value) ? formatted("%.3f %s", value, unit) : "-";
}

std::string text_of(const diagnostics::Histogram& histogram) {
  const diagnostics::Percentiles time_us = histogram.percentiles();
  return formatted("p50 %.0f, p99 %.0f, max %.0f us", time_us.p50_us, time_us.p99_us, time_us.max_us);
}

Check driver(const SelfTestResult& result, std::size_t joint) {
  Check check{kJointNames[joint], true, {}, {}};
  const double answered = share(result.answered[joint], result.commands[joint]);
  const double in_time = share(result.in_time[joint], result.ticks);
  check.measured = formatted("%.2f %% of %lld commands answered, %.2f %% in time, at most %u missed in a row",
                             100 * answered, result.commands[joint], 100 * in_time, result.missed[joint]);
  check.limit = formatted("%.2f and %.2f %%, fewer than %u in a row", 100 * result.limits.answered_share,
                          100 * result.limits.in_time_share, result.limits.missed_damp);
  check.passed = answered >= result.limits.answered_share && in_time >= result.limits.in_time_share &&
                 result.missed[joint] < result.limits.missed_damp;
  if (result.fault[joint] != hal::DriverFault::none) {
    check.passed = false;
    check.measured += formatted(", fault: %s (%u)", name(result.fault[joint]), result.fault_code[joint]);
    check.limit += ", no fault";
  }
  return check;
}

Check torso_sensor(const SelfTestResult& result) {
  const hal::BaseReading& base = result.last.base;
  return {"torso sensor",
          std::isfinite(base.pitch_rad) && std::isfinite(base.pitch_rate_rad_s) &&
              result.base_missed < result.limits.missed_damp,
          formatted("%lld readings, at most %u missed in a row, pitch %s", result.base_readings,
                    result.base_missed, measured(base.pitch_rad, "rad").c_str()),
          formatted("pitch and rate, fewer than %u missed in a row", result.limits.missed_damp)};
}

/// Heat and supply over the whole test. Drivers that do not report them are within their limits.
Check heat_and_supply(const SelfTestResult& result) {
  const bool passed = result.limit_trouble.empty();
  return {"heat and supply", passed, passed ? "within the limits of the supervisor" : result.limit_trouble,
          ""};
}

Check emergency_stop(const SelfTestResult& result) {
  const bool absent = result.last.emergency_stop == hal::EmergencyStopState::absent;
  const bool accepted = absent && result.limits.accept_missing_stop;
  return {"emergency stop",
          !result.emergency_stop_pressed && !result.emergency_stop_silent && (accepted || !absent),
          result.emergency_stop_pressed  ? "pressed"
          : result.emergency_stop_silent ? "silent"
          : accepted                     ? "not wired to this program, accepted by --accept-missing-stop"
          : absent                       ? "not wired to this program"
                                         : "released",
          accepted ? ""
          : absent ? "released, or --accept-missing-stop where only the motors' supply is cut"
                   : "released"};
}

/// Limp legs of a robot that hangs are plumb lines. An offset that is void after a power cycle shows here.
Check plumb(const SelfTestResult& result) {
  const hal::JointValues at_rad = commissioning::joint_angles(result.last);
  const double pitch_rad = result.last.base.pitch_rad;
  const double by_legs_rad = commissioning::plumb_pitch_rad(at_rad);
  return {"plumb",
          commissioning::legs_plumb(at_rad) && std::abs(pitch_rad - by_legs_rad) < commissioning::kPlumb_rad,
          formatted("hips at %.2f and %.2f rad, knees at %.2f and %.2f, torso at %.2f", at_rad[0], at_rad[2],
                    at_rad[1], at_rad[3], pitch_rad),
          formatted("knees at 0, hips at minus the torso, within %.2f rad", commissioning::kPlumb_rad)};
}

Check errors_of_buses(const SelfTestResult& result) {
  long long commands = 0;
  for (const long long of_joint : result.commands) commands += of_joint;
  const auto most =
      static_cast<long long>((1.0 - result.limits.answered_share) * static_cast<double>(commands));
  const bool there = result.bus_trouble.empty();
  return {"bus errors", there && result.bus_errors <= most,
          (there ? "" : result.bus_trouble + "; ") + std::to_string(result.bus_errors),
          "at most " + std::to_string(most)};
}

Check wakeup_check(const SelfTestResult& result) {
  return {"wake-up", share(result.late_ticks, result.ticks) <= result.limits.late_share,
          text_of(result.wakeup_latency) +
              formatted(", %lld of %lld ticks late", result.late_ticks, result.ticks),
          formatted("%.2f %% later than %.0f us", 100 * result.limits.late_share,
                    1e6 * result.limits.wakeup_latency_max_s)};
}

/// Solves within their period, nearly as many as the test had periods, and nearly all with a plan.
Check planner(const SelfTestResult& result) {
  const auto solves = static_cast<long long>(result.solve.count());
  const double periods = result.planner_s / result.limits.plan_period_s;
  const auto fewest = std::max(1LL, std::llround(std::floor(kFewestSolves * periods)));
  const bool in_time = result.solve.percentile_us(0.99) <= 1e6 * result.limits.plan_period_s;
  return {
      "planner", in_time && solves >= fewest && share(result.failed_solves, solves) <= kFailedSolves,
      text_of(result.solve) + formatted(", %lld solves, %lld without a plan", solves, result.failed_solves),
      formatted("p99 within %.0f us, at least %lld solves, at most %.0f %% without a plan",
                1e6 * result.limits.plan_period_s, fewest, 100 * kFailedSolves)};
}

Check interrupt_threads(const SelfTestResult& result) {
  const std::string limit =
      formatted("priority above %d (chrt -f -p), or another processor", result.limits.planner_priority);
  std::string waiting;
  for (const realtime::InterruptThread& thread : result.interrupts) {
    waiting += (waiting.empty() ? "" : "; ") + thread_text(thread) + " waits for the planner";
  }
  std::string others;
  for (const std::string& sentence : result.interrupt_sentences) {
    others += (others.empty() ? "" : "; ") + sentence;
  }
  if (others.empty()) others = "no bus has an adapter";
  return {"interrupts", waiting.empty(), waiting.empty() ? others : waiting + "; " + others, limit};
}

Check idle_states(const SelfTestResult& result) {
  const double most_us = 1e6 * result.limits.wakeup_latency_max_s;
  if (!result.idle) return {"idle states", true, "not reported by the kernel", ""};
  const double exit_us = std::min(result.idle->exit_us, result.idle_held_us.value_or(result.idle->exit_us));
  std::string measured = formatted("%s, %.0f us to wake", result.idle->name.c_str(), result.idle->exit_us);
  if (exit_us < result.idle->exit_us) measured += formatted(", not used: held at %.0f us", exit_us);
  return {"idle states", exit_us <= most_us, measured, formatted("at most %.0f us", most_us)};
}

Check throttling(const SelfTestResult& result) {
  if (!result.throttled) return {"throttling", true, "not reported by the kernel", ""};
  return {"throttling", *result.throttled == 0, std::to_string(*result.throttled) + " times", "never"};
}

}  // namespace

bool SelfTestResult::answered_enough() const noexcept {
  if (!failure.empty() || ticks == 0) return false;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    if (share(answered[joint], commands[joint]) < limits.answered_share) return false;
  }
  return true;
}

bool SelfTestResult::in_time_enough() const noexcept {
  return failure.empty() && ticks > 0 && std::ranges::all_of(in_time, [this](long long of_joint) {
           return share(of_joint, ticks) >= limits.in_time_share;
         });
}

std::vector<Check> SelfTestResult::checks() const {
  if (!failure.empty() || ticks == 0) return {};
  std::vector<Check> all{errors_of_buses(*this)};  // first: all that is on a bus is silent where it is gone
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) all.push_back(driver(*this, joint));
  all.insert(all.end(), {torso_sensor(*this), heat_and_supply(*this), emergency_stop(*this)});
  if (limits.hangs) all.push_back(plumb(*this));
  if (lockstep) return all;
  all.insert(all.end(), {wakeup_check(*this), planner(*this), interrupt_threads(*this), idle_states(*this),
                         throttling(*this)});
  return all;
}

bool SelfTestResult::passed() const {
  const std::vector<Check> all = checks();
  return stopped.empty() && !all.empty() && std::ranges::all_of(all, &Check::passed);
}

std::string to_text(const SelfTestResult& result) {
  if (!result.failure.empty()) return result.failure + '\n';
  std::string text;
  for (const Check& check : result.checks()) {
    text += formatted("%-7s %-15s ", check.passed ? "ok" : "FAILED", check.name.c_str()) + check.measured;
    text += check.limit.empty() ? "\n" : " (limit: " + check.limit + ")\n";
  }
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const hal::JointReading& reading = result.last.joints[joint];
    text += std::string(kJointNames[joint]) + " at " + measured(reading.position_rad, "rad") + ", driver " +
            measured(reading.driver_temperature_C, "C") + ", supply " + measured(reading.supply_V, "V") +
            '\n';
  }
  if (result.round_trip.count() > 0) text += "round trip " + text_of(result.round_trip) + '\n';
  if (result.passed()) return text + "passed\n";
  if (!result.stopped.empty()) return text + "failed: " + result.stopped + '\n';
  if (result.answered_enough() && !result.in_time_enough()) {
    return text + "failed: the drivers answer, but too late; wake-up and round trip show what is late\n";
  }
  return text + "failed\n";
}

std::string to_json(const SelfTestResult& result) {
  const auto percentiles = [](const diagnostics::Histogram& histogram) {
    const diagnostics::Percentiles time_us = histogram.percentiles();
    return nlohmann::ordered_json{{"p50", time_us.p50_us}, {"p99", time_us.p99_us}, {"max", time_us.max_us}};
  };
  nlohmann::ordered_json json;
  json["good"] = json["passed"] = result.passed();
  const std::string& error = result.failure.empty() ? result.stopped : result.failure;
  if (!error.empty()) json["failure"] = json["error"] = error;
  json["checks"] = nlohmann::ordered_json::array();
  for (const Check& check : result.checks()) {
    json["checks"].push_back({{"name", check.name},
                              {"passed", check.passed},
                              {"measured", check.measured},
                              {"limit", check.limit}});
  }
  json["commands"] = result.ticks;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    json["reply_share"][kJointNames[joint]] = share(result.answered[joint], result.commands[joint]);
    json["in_time_share"][kJointNames[joint]] = share(result.in_time[joint], result.ticks);
    json["missed_replies"][kJointNames[joint]] = result.missed[joint];
    json["position_rad"][kJointNames[joint]] = result.last.joints[joint].position_rad;
  }
  json["base_readings"] = result.base_readings;
  json["base_missed_replies"] = result.base_missed;
  json["base_pitch_rad"] = result.last.base.pitch_rad;
  json["bus_errors"] = result.bus_errors;
  json["bus_round_trip_us"] = percentiles(result.round_trip);
  json["wakeup_us"] = percentiles(result.wakeup_latency);
  json["late_ticks"] = result.late_ticks;
  json["lockstep"] = result.lockstep;
  if (result.solve.count() > 0) json["solve_us"] = percentiles(result.solve);
  if (!result.lockstep) {
    json["solves"] = result.solve.count();
    json["failed_solves"] = result.failed_solves;
  }
  return commissioning::json_text(json);
}

}  // namespace stilt::program
