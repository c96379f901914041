#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "firmware/control_loop/tick_record.h"

/// The fields of a TickRecord in one table. From it follow the message (firmware/telemetry/tick_batch.h), the
/// CSV file (firmware/diagnostics/tick_csv.h), the columns of the monitor's page
/// (host_tools/web/monitor/page_tables.h) and the comparison of a replay
/// (host_tools/recording/replay/difference.h). The number of the tick is not in the table: it counts the rows
/// of them all.
namespace stilt::control_loop {

// clang-format off
/// Fields that belong together, in the order in which a tick works; outputs from the estimate on. All fields
/// of a group have equally many values.
enum class TickGroup : std::uint8_t {
  clock, timing, drivers, joints, base, request, planner,
  estimate, faults, reaction, decision, ramp, gait, plan, tuning, wanted, action, sent,
};
// clang-format on

inline constexpr auto kFirstOutput = static_cast<std::size_t>(TickGroup::estimate);
inline constexpr auto kTickGroups = static_cast<std::size_t>(TickGroup::sent) + 1;

/// Names of a field where it is shown, units as suffixes; empty: not shown there. See unit_factor().
struct TickFieldNames {
  std::string_view csv = {};     ///< column; * stands for the joint or the component of the state
  std::string_view page = {};    ///< column of the monitor
  std::string_view replay = {};  ///< in sentences about an output; empty: "sent torque_Nm" for sent_torque_Nm
};

namespace internal {

template <class Member>
inline constexpr std::size_t kLength = 1;
template <class Element, std::size_t kSize>
inline constexpr std::size_t kLength<std::array<Element, kSize>> = kSize;

template <class Class, class Member>
constexpr std::size_t length(Member Class::* /*member*/) noexcept {
  return kLength<Member>;
}

template <class Value>
constexpr Value& follow(Value& value, std::size_t /*index*/) noexcept {
  return value;
}

/// Member after member from an object on; of an array the entry `index`.
template <class Object, class Class, class Member, class... Rest>
constexpr auto& follow(Object& object, std::size_t index, Member Class::* member, Rest... rest) noexcept {
  if constexpr (kLength<Member> != 1) {
    return follow((object.*member)[index], index, rest...);
  } else {
    return follow(object.*member, index, rest...);
  }
}

}  // namespace internal

/// A field: its group, its names, and the members that lead to it.
/// @tparam WireType  of its numbers in the message when that does not follow from the member, else void
template <TickGroup kOfGroup, class WireType, class... Members>
class TickField {
 public:
  static constexpr TickGroup kGroup = kOfGroup;
  using Wire = WireType;

  constexpr TickField(std::string_view on_wire, TickFieldNames shown, Members... members) noexcept
      : wire(on_wire), names(shown), members_(members...) {}

  /// Value `index` of the field, as const as the record.
  template <class Record>
  [[nodiscard]] constexpr auto& at(Record& record, std::size_t index = 0) const noexcept {
    return std::apply([&](auto... members) -> auto& { return internal::follow(record, index, members...); },
                      members_);
  }

  /// Number of values: 1, that of the joints or that of the states.
  [[nodiscard]] constexpr std::size_t count() const noexcept {
    return std::apply([](auto... members) { return std::max({internal::length(members)...}); }, members_);
  }

  std::string_view wire;  ///< sequence of TickBatch_ in stilt_msgs.idl
  TickFieldNames names;

 private:
  std::tuple<Members...> members_;
};

namespace internal {

template <TickGroup kGroup, class Wire = void, class... Members>
constexpr auto field(std::string_view wire, TickFieldNames names, Members... members) noexcept {
  return TickField<kGroup, Wire, Members...>(wire, names, members...);
}

/// Rows of the table. Local names keep them to a line.
constexpr auto tick_fields() noexcept {
  using G = TickGroup;
  using R = TickRecord;
  using Joint = hal::JointReading;
  using Base = hal::BaseReading;
  using BringUp = hal::BringUpProgress;
  using Result = PlanningResult;
  using Command = hal::JointCommand;
  using Names = TickFieldNames;
  using Text = std::string_view;
  // clang-format off
  const auto joint = [](Text wire, Names names, auto member) { return field<G::joints>(wire, names, &R::joints, member); };
  const auto base = [](Text wire, Names names, auto member) { return field<G::base>(wire, names, &R::base, member); };
  const auto request = [](Text wire, auto... members) { return field<G::request>(wire, {}, &R::command, members...); };
  const auto wanted = [](Text wire, Names names, auto member) { return field<G::wanted>(wire, names, &R::wanted, member); };
  const auto sent = [](Text wire, Names names, auto member) { return field<G::sent>(wire, names, &R::sent, member); };
  return std::tuple{
      field<G::clock>("time_ns", {}, &R::time_ns),
      field<G::timing>("wakeup_latency_ns", {.csv = "wakeup_latency_us", .page = "wakeup_latency_us"}, &R::wakeup_latency_ns),
      field<G::timing>("execution_ns", {.csv = "execution_us", .page = "execution_us"}, &R::execution_ns),
      field<G::timing>("bus_round_trip_ns", {.csv = "bus_round_trip_us", .page = "bus_round_trip_us"}, &R::bus_round_trip_ns),
      field<G::drivers>("read_status", {}, &R::read_status),
      field<G::drivers>("write_status", {}, &R::write_status),
      joint("joint_position_rad", {.csv = "*_position_rad"}, &Joint::position_rad),
      joint("joint_velocity_rad_s", {.csv = "*_velocity_rad_s"}, &Joint::velocity_rad_s),
      joint("joint_torque_Nm", {.csv = "*_torque_Nm"}, &Joint::torque_Nm),
      joint("driver_temperature_C", {.csv = "*_driver_temperature_C"}, &Joint::driver_temperature_C),
      joint("motor_temperature_C", {.csv = "*_motor_temperature_C"}, &Joint::motor_temperature_C),
      joint("supply_V", {.csv = "*_supply_V"}, &Joint::supply_V),
      joint("joint_time_ns", {}, &Joint::time_ns),
      joint("joint_missed_replies", {.csv = "*_missed_replies"}, &Joint::missed_replies),
      joint("joint_unchanged_replies", {.csv = "*_unchanged_replies"}, &Joint::unchanged_replies),
      joint("joint_malformed", {}, &Joint::malformed),
      joint("driver_state", {.csv = "*_driver_state"}, &Joint::state),
      joint("driver_fault", {.csv = "*_driver_fault"}, &Joint::fault),
      joint("driver_fault_code", {.csv = "*_driver_fault_code"}, &Joint::fault_code),
      base("base_pitch_rad", {.csv = "base_pitch_rad"}, &Base::pitch_rad),
      base("base_pitch_rate_rad_s", {.csv = "base_pitch_rate_rad_s"}, &Base::pitch_rate_rad_s),
      base("base_acceleration_x_m_s2", {.csv = "base_acceleration_x_m_s2"}, &Base::acceleration_x_m_s2),
      base("base_acceleration_z_m_s2", {.csv = "base_acceleration_z_m_s2"}, &Base::acceleration_z_m_s2),
      base("left_foot_force_N", {.csv = "left_foot_force_N"}, &Base::left_foot_force_N),
      base("right_foot_force_N", {.csv = "right_foot_force_N"}, &Base::right_foot_force_N),
      base("base_time_ns", {}, &Base::time_ns),
      base("base_missed_replies", {.csv = "base_missed_replies"}, &Base::missed_replies),
      base("base_unchanged_replies", {.csv = "base_unchanged_replies"}, &Base::unchanged_replies),
      base("base_malformed", {}, &Base::malformed),
      field<G::drivers>("emergency_stop", {}, &R::emergency_stop),
      field<G::drivers>("bus_errors", {}, &R::bus_errors),
      field<G::drivers>("bring_up_ready", {}, &R::bring_up, &BringUp::ready),
      field<G::drivers>("bring_up_failed", {}, &R::bring_up, &BringUp::failed),
      field<G::drivers, std::uint8_t>("bring_up_joint", {}, &R::bring_up, &BringUp::joint),
      field<G::drivers>("bring_up_stage", {}, &R::bring_up, &BringUp::stage),
      field<G::drivers>("bring_up_failure", {}, &R::bring_up, &BringUp::failure),
      field<G::drivers>("bring_up_fault", {}, &R::bring_up, &BringUp::fault),
      request("request_kind", &OperatorCommand::request, &supervisor::Request::kind),
      request("request_number", &OperatorCommand::request, &supervisor::Request::number),
      request("request_speed_m_s", &OperatorCommand::request, &supervisor::Request::speed_m_s),
      request("shut_down", &OperatorCommand::shut_down),
      request("heartbeat_expected", &OperatorCommand::heartbeat_expected),
      request("heartbeat_ns", &OperatorCommand::heartbeat_ns),
      field<G::tuning>("tuning", {}, &R::tuning),
      field<G::planner>("visible_plan", {}, &R::visible_plan),
      field<G::planner>("result_cycles", {}, &R::result, &Result::cycles),
      field<G::planner>("result_failures", {}, &R::result, &Result::failures_in_a_row),
      field<G::planner>("result_stance_episode", {}, &R::result, &Result::stance_episode),
      field<G::planner>("result_solve_ns", {}, &R::result, &Result::solve_ns),
      field<G::planner>("result_status", {}, &R::result, &Result::status),

      field<G::estimate>("estimated_state", {.csv = "estimated_*"}, &R::estimated_state),
      wanted("wanted_position_rad", {.csv = "wanted_*_position_rad"}, &Command::position_rad),
      wanted("wanted_velocity_rad_s", {.csv = "wanted_*_velocity_rad_s"}, &Command::velocity_rad_s),
      wanted("wanted_torque_Nm", {.csv = "wanted_*_torque_Nm"}, &Command::torque_Nm),
      wanted("wanted_kp_Nm_rad", {.csv = "wanted_*_kp_Nm_rad"}, &Command::kp_Nm_rad),
      wanted("wanted_kd_Nms_rad", {.csv = "wanted_*_kd_Nms_rad"}, &Command::kd_Nms_rad),
      wanted("wanted_torque_limit_Nm", {}, &Command::torque_limit_Nm),
      sent("sent_position_rad", {.csv = "sent_*_position_rad"}, &Command::position_rad),
      sent("sent_velocity_rad_s", {.csv = "sent_*_velocity_rad_s"}, &Command::velocity_rad_s),
      sent("sent_torque_Nm", {.csv = "sent_*_torque_Nm"}, &Command::torque_Nm),
      sent("sent_kp_Nm_rad", {.csv = "sent_*_kp_Nm_rad"}, &Command::kp_Nm_rad),
      sent("sent_kd_Nms_rad", {.csv = "sent_*_kd_Nms_rad"}, &Command::kd_Nms_rad),
      sent("sent_torque_limit_Nm", {}, &Command::torque_limit_Nm),
      field<G::action>("action", {.csv = "action"}, &R::action),
      field<G::decision>("state", {.csv = "state", .page = "state_number"}, &R::state),
      field<G::decision>("fallback_level", {.csv = "fallback_level", .page = "fallback_level"}, &R::level),
      field<G::reaction>("reaction", {.csv = "reaction"}, &R::reaction),
      field<G::faults>("present_faults", {.csv = "faults"}, &R::present),
      field<G::faults>("latched_faults", {.csv = "latched_faults"}, &R::latched),
      field<G::ramp>("ramp", {.csv = "ramp", .page = "ramp"}, &R::ramp),
      field<G::plan>("plan_sequence", {.csv = "plan_sequence", .replay = "sequence of the plan in use"}, &R::plan_sequence),
      field<G::plan>("plan_age_s", {.csv = "plan_age_s", .page = "plan_age_ms", .replay = "plan_age_s"}, &R::plan_age_s),
      field<G::gait>("stance_episode", {}, &R::stance_episode),
      field<G::gait>("gait", {}, &R::gait, &gait::GaitCommand::kind),
      field<G::gait>("gait_speed_m_s", {.page = "commanded_speed_m_s"}, &R::gait, &gait::GaitCommand::speed_m_s),
      field<G::drivers>("bring_up_fault_code", {}, &R::bring_up, &BringUp::fault_code),
      field<G::drivers>("bring_up_setting", {}, &R::bring_up, &BringUp::setting),
      field<G::drivers>("bring_up_reply_lag_s", {}, &R::bring_up, &BringUp::reply_lag_s),
      field<G::drivers>("bring_up_version", {}, &R::bring_up, &BringUp::version),
      field<G::drivers>("bring_up_wanted_version", {}, &R::bring_up, &BringUp::wanted_version),
  };
  // clang-format on
}

}  // namespace internal

/// In the order of the message.
inline constexpr auto kTickFields = internal::tick_fields();
inline constexpr std::size_t kTickFieldCount = std::tuple_size_v<decltype(kTickFields)>;

/// Calls visit(field) for every field, in the order of the table.
template <class Visit>
constexpr void for_each_tick_field(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kTickFields);
}

/// Calls visit(field) for every field of a group, in the order of the table.
template <TickGroup kGroup, class Visit>
constexpr void for_each_field_of(Visit&& visit) {
  for_each_tick_field([&](const auto& field) {
    if constexpr (std::remove_cvref_t<decltype(field)>::kGroup == kGroup) visit(field);
  });
}

/// Calls visit(field, index) for every value of a group: all fields of the first joint, then of the second.
template <TickGroup kGroup, class Visit>
constexpr void for_each_value_of(Visit&& visit) {
  std::size_t count = 0;
  for_each_field_of<kGroup>([&](const auto& field) { count = field.count(); });
  for (std::size_t i = 0; i < count; ++i) {
    for_each_field_of<kGroup>([&](const auto& field) { visit(field, i); });
  }
}

/// Calls visit(field, index) for every value that a tick puts out, in the order in which it works.
template <class Visit>
constexpr void for_each_output(Visit&& visit) {
  [&]<std::size_t... kGroup>(std::index_sequence<kGroup...>) {
    (for_each_value_of<static_cast<TickGroup>(kFirstOutput + kGroup)>(visit), ...);
  }(std::make_index_sequence<kTickGroups - kFirstOutput>());
}

/// Factor on a number that is called `from` to show it as `to`: from _ns to _us, from _s to _ms, else 1.
[[nodiscard]] constexpr double unit_factor(std::string_view from, std::string_view to) noexcept {
  if (from.ends_with("_ns") && to.ends_with("_us")) return 1e-3;
  if (from.ends_with("_s") && to.ends_with("_ms")) return 1e3;
  return 1.0;
}

}  // namespace stilt::control_loop
