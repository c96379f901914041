#include "host_tools/recording/replay/difference.h"

#include <bit>
#include <charconv>
#include <type_traits>

#include "firmware/control_loop/joint_names.h"
#include "firmware/control_loop/tick_fields.h"

namespace stilt::replay {
namespace {

template <class T>
std::string text_of(T value) {
  if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<long long>(value));
  } else if constexpr (std::is_same_v<T, supervisor::FaultSet>) {
    return std::to_string(value.bits());
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

/// Stores the first pair that differs.
class Comparison {
 public:
  explicit Comparison(std::uint64_t tick) { difference_.tick = tick; }

  template <class T>
  void add(const char* what, T recorded, T replayed, const char* of) {
    add(recorded, replayed, [&] { return what + (" of " + std::string(of)); });
  }
  template <class T>
  void add(const char* what, T recorded, T replayed) {
    add(recorded, replayed, [&] { return what; });
  }

  /// @param what  returns the name, called only when the values differ
  template <class T, class MakeName>
  void add(T recorded, T replayed, MakeName what) {
    if (found_ || same(recorded, replayed)) return;
    found_ = true;
    difference_.what = what();
    difference_.recorded = text_of(recorded);
    difference_.replayed = text_of(replayed);
  }

  [[nodiscard]] std::optional<Difference> result() const {
    return found_ ? std::optional(difference_) : std::nullopt;
  }

 private:
  Difference difference_;
  bool found_ = false;
};

/// Name of an output in a sentence: "ramp", "sent torque_Nm of knee_L", "estimated state of 3".
std::string name_of(std::string_view wire, std::string_view replay, std::size_t count, std::size_t index) {
  std::string name(replay.empty() ? wire : replay);
  if (const std::size_t first = name.find('_'); replay.empty() && first != std::string::npos) {
    name[first] = ' ';
  }
  if (count == hal::kJoints) name += std::string(" of ") + control_loop::kJointNames[index];
  if (count == model::kStates) name += " of " + std::to_string(index);
  return name;
}

}  // namespace

std::string Difference::text() const {
  return "tick " + std::to_string(tick) + ": " + what + " was " + recorded + " and is " + replayed;
}

std::optional<Difference> compare(const control_loop::TickRecord& recorded,
                                  const control_loop::TickRecord& replayed) {
  Comparison comparison(recorded.tick);
  comparison.add("tick", recorded.tick, replayed.tick);
  control_loop::for_each_output([&](const auto& field, std::size_t index) {
    comparison.add(field.at(recorded, index), field.at(replayed, index),
                   [&] { return name_of(field.wire, field.names.replay, field.count(), index); });
  });
  return comparison.result();
}

std::optional<Difference> compare(const control_loop::CycleRecord& recorded,
                                  const control_loop::CycleRecord& replayed) {
  Comparison comparison(static_cast<std::uint64_t>(recorded.tick));
  comparison.add("number of solves", recorded.cycle, replayed.cycle);
  comparison.add("stance episode", recorded.stance_episode, replayed.stance_episode, "the plan's request");
  comparison.add("time_s", recorded.time_s, replayed.time_s, "the plan's request");
  comparison.add("status", recorded.report.status, replayed.report.status, "the solve");
  comparison.add("iterations", recorded.report.iterations, replayed.report.iterations, "the solve");
  comparison.add("cost", recorded.report.cost, replayed.report.cost, "the solve");
  comparison.add("dynamics_defect_max", recorded.report.dynamics_defect_max,
                 replayed.report.dynamics_defect_max, "the solve");
  comparison.add("equality_violation_max", recorded.report.equality_violation_max,
                 replayed.report.equality_violation_max, "the solve");
  const ocp::Violations& before = recorded.report.violations;
  const ocp::Violations& now = replayed.report.violations;
  comparison.add("friction_cone_violation_max_N", before.friction_cone_violation_max_N,
                 now.friction_cone_violation_max_N, "the solve");
  comparison.add("pulling_force_max_N", before.pulling_force_max_N, now.pulling_force_max_N, "the solve");
  comparison.add("impulse_cone_violation_max_Ns", before.impulse_cone_violation_max_Ns,
                 now.impulse_cone_violation_max_Ns, "the solve");
  comparison.add("torque_violation_max_Nm", before.torque_violation_max_Nm, now.torque_violation_max_Nm,
                 "the solve");
  comparison.add("position_violation_max_rad", before.position_violation_max_rad,
                 now.position_violation_max_rad, "the solve");
  comparison.add("velocity_violation_max_rad_s", before.velocity_violation_max_rad_s,
                 now.velocity_violation_max_rad_s, "the solve");
  comparison.add("line_search_step", recorded.report.line_search_step, replayed.report.line_search_step,
                 "the solve");
  comparison.add("step_component_max", recorded.report.step_component_max, replayed.report.step_component_max,
                 "the solve");
  comparison.add("failures in a row", recorded.failures, replayed.failures);
  comparison.add("sequence", recorded.plan_sequence, replayed.plan_sequence, "the plan");
  comparison.add("nodes", recorded.nodes, replayed.nodes, "the plan");
  comparison.add("check sum", recorded.checksum, replayed.checksum, "the plan");
  return comparison.result();
}

}  // namespace stilt::replay
