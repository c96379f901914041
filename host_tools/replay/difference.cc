#include "host_tools/replay/difference.h"

#include <bit>
#include <charconv>
#include <type_traits>

namespace stilt::replay {
namespace {

constexpr const char* kJoints[] = {"hip_L", "knee_L", "hip_R", "knee_R"};

template <class T>
std::string text_of(T value) {
  if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<long long>(value));
  } else {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
  }
}

template <class T>
bool same(T a, T b) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else {
    return a == b;
  }
}

/// Remembers the first pair that differs.
class Comparison {
 public:
  explicit Comparison(std::uint64_t tick) { difference_.tick = tick; }

  template <class T>
  void add(const char* what, T recorded, T replayed, const char* of = nullptr) {
    if (found_ || same(recorded, replayed)) return;
    found_ = true;
    difference_.what = of == nullptr ? what : std::string(what) + " of " + of;
    difference_.recorded = text_of(recorded);
    difference_.replayed = text_of(replayed);
  }

  void add_commands(const std::string& name, const hal::JointCommands& recorded,
                    const hal::JointCommands& replayed) {
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      const hal::JointCommand &a = recorded[i], &b = replayed[i];
      add((name + " torque_Nm").c_str(), a.torque_Nm, b.torque_Nm, kJoints[i]);
      add((name + " position_rad").c_str(), a.position_rad, b.position_rad, kJoints[i]);
      add((name + " velocity_rad_s").c_str(), a.velocity_rad_s, b.velocity_rad_s, kJoints[i]);
      add((name + " kp_Nm_rad").c_str(), a.kp_Nm_rad, b.kp_Nm_rad, kJoints[i]);
      add((name + " kd_Nms_rad").c_str(), a.kd_Nms_rad, b.kd_Nms_rad, kJoints[i]);
      add((name + " torque_limit_Nm").c_str(), a.torque_limit_Nm, b.torque_limit_Nm, kJoints[i]);
    }
  }

  [[nodiscard]] std::optional<Difference> result() const {
    return found_ ? std::optional(difference_) : std::nullopt;
  }

 private:
  Difference difference_;
  bool found_ = false;
};

}  // namespace

std::string Difference::text() const {
  return "tick " + std::to_string(tick) + ": " + what + " was " + recorded + " and is " + replayed;
}

std::optional<Difference> compare(const control_loop::TickRecord& recorded,
                                  const control_loop::TickRecord& replayed) {
  Comparison comparison(recorded.tick);
  comparison.add("tick", recorded.tick, replayed.tick);
  for (std::size_t i = 0; i < recorded.estimated_state.size(); ++i) {
    const std::string number = std::to_string(i);
    comparison.add("estimated state", recorded.estimated_state[i], replayed.estimated_state[i],
                   number.c_str());
  }
  comparison.add("present faults", recorded.present.bits(), replayed.present.bits());
  comparison.add("latched faults", recorded.latched.bits(), replayed.latched.bits());
  comparison.add("reaction", recorded.reaction, replayed.reaction);
  comparison.add("state", recorded.state, replayed.state);
  comparison.add("level", recorded.level, replayed.level);
  comparison.add("ramp", recorded.ramp, replayed.ramp);
  comparison.add("standing", recorded.standing, replayed.standing);
  comparison.add("gait", recorded.gait.kind, replayed.gait.kind);
  comparison.add("gait speed_m_s", recorded.gait.speed_m_s, replayed.gait.speed_m_s);
  comparison.add("sequence of the plan in use", recorded.plan_sequence, replayed.plan_sequence);
  comparison.add("plan_age_s", recorded.plan_age_s, replayed.plan_age_s);
  comparison.add("tuning", recorded.tuning, replayed.tuning);
  comparison.add_commands("wanted", recorded.wanted, replayed.wanted);
  comparison.add("action", recorded.action, replayed.action);
  comparison.add_commands("sent", recorded.sent, replayed.sent);
  return comparison.result();
}

std::optional<Difference> compare(const control_loop::CycleRecord& recorded,
                                  const control_loop::CycleRecord& replayed) {
  Comparison comparison(static_cast<std::uint64_t>(recorded.tick));
  comparison.add("number of solves", recorded.cycle, replayed.cycle);
  comparison.add("standing", recorded.standing, replayed.standing, "the plan's request");
  comparison.add("time_s", recorded.time_s, replayed.time_s, "the plan's request");
  comparison.add("status", recorded.report.status, replayed.report.status, "the solve");
  comparison.add("iterations", recorded.report.iterations, replayed.report.iterations, "the solve");
  comparison.add("cost", recorded.report.cost, replayed.report.cost, "the solve");
  comparison.add("dynamics_defect_max", recorded.report.dynamics_defect_max,
                 replayed.report.dynamics_defect_max, "the solve");
  comparison.add("equality_violation_max", recorded.report.equality_violation_max,
                 replayed.report.equality_violation_max, "the solve");
  comparison.add("step_length", recorded.report.step_length, replayed.report.step_length, "the solve");
  comparison.add("step_size", recorded.report.step_size, replayed.report.step_size, "the solve");
  comparison.add("failures in a row", recorded.failures, replayed.failures);
  comparison.add("sequence", recorded.plan_sequence, replayed.plan_sequence, "the plan");
  comparison.add("nodes", recorded.nodes, replayed.nodes, "the plan");
  comparison.add("check sum", recorded.checksum, replayed.checksum, "the plan");
  return comparison.result();
}

}  // namespace stilt::replay
