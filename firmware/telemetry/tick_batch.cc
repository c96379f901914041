#include "firmware/telemetry/tick_batch.h"

#include <array>
#include <type_traits>
#include <vector>

namespace stilt::telemetry {
namespace {

using control_loop::TickRecord;

constexpr std::size_t kJoints = hal::kJoints;

/// A number of a record, as `column.take(value)`; which of the ways it goes is the visitor's. One list of
/// fields serves writing, reading and counting.
///
/// @param column  takes (sequence of the message, how many a tick, place in the record of the i-th)
template <class Batch, class Record, class Column>
void visit_inputs(Batch& b, Record& r, Column&& column) {
  const auto one = [&](auto& sequence, auto& field) {
    column(
        sequence, 1, [&](std::size_t) -> auto& { return field; });
  };
  const auto joints = [&](auto& sequence, auto member) {
    column(
        sequence, kJoints, [&r, member ](std::size_t i) -> auto& { return r.joints[i].*member; });
  };
  one(b.time_ns, r.time_ns);
  one(b.late_ns, r.wakeup_ns);
  one(b.execution_ns, r.execution_ns);
  one(b.round_trip_ns, r.round_trip_ns);
  one(b.read_status, r.read_status);
  one(b.write_status, r.write_status);
  joints(b.joint_position_rad, &hal::JointReading::position_rad);
  joints(b.joint_velocity_rad_s, &hal::JointReading::velocity_rad_s);
  joints(b.joint_torque_Nm, &hal::JointReading::torque_Nm);
  joints(b.driver_temperature_C, &hal::JointReading::driver_temperature_C);
  joints(b.motor_temperature_C, &hal::JointReading::motor_temperature_C);
  joints(b.supply_V, &hal::JointReading::supply_V);
  joints(b.joint_time_ns, &hal::JointReading::time_ns);
  joints(b.joint_missed, &hal::JointReading::missed);
  joints(b.joint_frozen, &hal::JointReading::frozen);
  joints(b.joint_malformed, &hal::JointReading::malformed);
  joints(b.driver_state, &hal::JointReading::state);
  joints(b.driver_fault, &hal::JointReading::fault);
  joints(b.driver_fault_code, &hal::JointReading::fault_code);
  one(b.base_pitch_rad, r.base.pitch_rad);
  one(b.base_pitch_rate_rad_s, r.base.pitch_rate_rad_s);
  one(b.base_acceleration_x_m_s2, r.base.acceleration_x_m_s2);
  one(b.base_acceleration_z_m_s2, r.base.acceleration_z_m_s2);
  one(b.left_foot_force_N, r.base.left_foot_force_N);
  one(b.right_foot_force_N, r.base.right_foot_force_N);
  one(b.base_time_ns, r.base.time_ns);
  one(b.base_missed, r.base.missed);
  one(b.base_frozen, r.base.frozen);
  one(b.base_malformed, r.base.malformed);
  one(b.emergency_stop, r.emergency_stop);
  one(b.bus_errors, r.bus_errors);
  one(b.bring_up_ready, r.bring_up.ready);
  one(b.bring_up_failed, r.bring_up.failed);
  one(b.bring_up_joint, r.bring_up.joint);
  one(b.bring_up_stage, r.bring_up.stage);
  one(b.bring_up_failure, r.bring_up.failure);
  one(b.bring_up_fault, r.bring_up.fault);
  one(b.request_kind, r.command.request.kind);
  one(b.request_number, r.command.request.number);
  one(b.request_speed_m_s, r.command.request.speed_m_s);
  one(b.shut_down, r.command.shut_down);
  one(b.heartbeat_expected, r.command.heartbeat_expected);
  one(b.heartbeat_ns, r.command.heartbeat_ns);
  one(b.tuning, r.tuning);
  one(b.visible_plan, r.visible_plan);
  one(b.result_cycles, r.result.cycles);
  one(b.result_failures, r.result.failures_in_a_row);
  one(b.result_standing, r.result.session);
  one(b.result_solve_ns, r.result.solve_ns);
  one(b.result_status, r.result.status);
}

template <class Batch, class Record, class Column>
void visit_outputs(Batch& b, Record& r, Column&& column) {
  const auto one = [&](auto& sequence, auto& field) {
    column(
        sequence, 1, [&](std::size_t) -> auto& { return field; });
  };
  const auto commands = [&](auto& sequence, auto& list, auto member) {
    column(
        sequence, kJoints, [&list, member ](std::size_t i) -> auto& { return list[i].*member; });
  };
  column(
      b.estimated_state, model::kStates, [&](std::size_t i) -> auto& { return r.estimated_state[i]; });
  commands(b.wanted_position_rad, r.wanted, &hal::JointCommand::position_rad);
  commands(b.wanted_velocity_rad_s, r.wanted, &hal::JointCommand::velocity_rad_s);
  commands(b.wanted_torque_Nm, r.wanted, &hal::JointCommand::torque_Nm);
  commands(b.wanted_kp_Nm_rad, r.wanted, &hal::JointCommand::kp_Nm_rad);
  commands(b.wanted_kd_Nms_rad, r.wanted, &hal::JointCommand::kd_Nms_rad);
  commands(b.wanted_torque_limit_Nm, r.wanted, &hal::JointCommand::torque_limit_Nm);
  commands(b.sent_position_rad, r.sent, &hal::JointCommand::position_rad);
  commands(b.sent_velocity_rad_s, r.sent, &hal::JointCommand::velocity_rad_s);
  commands(b.sent_torque_Nm, r.sent, &hal::JointCommand::torque_Nm);
  commands(b.sent_kp_Nm_rad, r.sent, &hal::JointCommand::kp_Nm_rad);
  commands(b.sent_kd_Nms_rad, r.sent, &hal::JointCommand::kd_Nms_rad);
  commands(b.sent_torque_limit_Nm, r.sent, &hal::JointCommand::torque_limit_Nm);
  one(b.action, r.action);
  one(b.state, r.state);
  one(b.rung, r.level);
  one(b.reaction, r.reaction);
  one(b.present_faults, r.present);
  one(b.latched_faults, r.latched);
  one(b.ramp, r.ramp);
  one(b.plan_sequence, r.plan_sequence);
  one(b.plan_age_s, r.plan_age_s);
  one(b.standing, r.standing);
  one(b.gait, r.gait.kind);
  one(b.gait_speed_m_s, r.gait.speed_m_s);
}

template <class Batch, class Record, class Column>
void visit(Batch& batch, Record& record, Column&& column) {
  visit_inputs(batch, record, column);
  visit_outputs(batch, record, column);
}

template <class Sequence>
using Element = std::remove_cvref_t<decltype(*std::declval<Sequence&>()._buffer)>;

template <class Wire, class Value>
Wire to_wire(const Value& value) noexcept {
  if constexpr (std::is_same_v<Value, supervisor::FaultSet>) {
    return value.bits();
  } else {
    return static_cast<Wire>(value);
  }
}

template <class Value, class Wire>
void from_wire(Wire wire, Value& value) noexcept {
  if constexpr (std::is_same_v<Value, supervisor::FaultSet>) {
    value = supervisor::FaultSet(wire);
  } else {
    value = static_cast<Value>(wire);
  }
}

}  // namespace

/// The message and the numbers of its sequences.
struct TickBatchBuilder::Memory {
  TickBatch message{};
  std::vector<std::unique_ptr<std::byte[]>> columns;
};

TickBatchBuilder::TickBatchBuilder() : memory_(std::make_unique<Memory>()) {
  TickRecord any;
  visit(memory_->message, any, [this](auto& sequence, std::size_t width, auto&&) {
    using Wire = Element<decltype(sequence)>;
    memory_->columns.push_back(std::make_unique<std::byte[]>(width * kTicksPerBatch * sizeof(Wire)));
    sequence._buffer = reinterpret_cast<Wire*>(memory_->columns.back().get());
    sequence._maximum = static_cast<std::uint32_t>(width * kTicksPerBatch);
  });
}

TickBatchBuilder::~TickBatchBuilder() = default;

const TickBatch& TickBatchBuilder::message() const noexcept { return memory_->message; }
TickBatch& TickBatchBuilder::message() noexcept { return memory_->message; }

bool TickBatchBuilder::takes(const TickRecord& record) const noexcept {
  const TickBatch& batch = memory_->message;
  return batch.count == 0 || (batch.count < kTicksPerBatch && record.tick == batch.first_tick + batch.count);
}

void TickBatchBuilder::add(const TickRecord& record) {
  TickBatch& batch = memory_->message;
  if (batch.count == 0) batch.first_tick = record.tick;
  visit(batch, record, [](auto& sequence, std::size_t width, auto&& at) {
    for (std::size_t i = 0; i < width; ++i) {
      sequence._buffer[sequence._length++] = to_wire<Element<decltype(sequence)>>(at(i));
    }
  });
  ++batch.count;
}

void TickBatchBuilder::clear() noexcept {
  const TickRecord any;
  visit(memory_->message, any, [](auto& sequence, std::size_t, auto&&) { sequence._length = 0; });
  memory_->message.count = 0;
}

bool well_formed(const TickBatch& batch) noexcept {
  const TickRecord any;
  bool right = true;
  visit(batch, any, [&](const auto& sequence, std::size_t width, auto&&) {
    right = right && sequence._length == width * batch.count;
  });
  return right;
}

TickRecord tick_record(const TickBatch& batch, std::size_t index) noexcept {
  TickRecord record;
  record.tick = batch.first_tick + index;
  visit(batch, record, [index](const auto& sequence, std::size_t width, auto&& at) {
    for (std::size_t i = 0; i < width; ++i) from_wire(sequence._buffer[index * width + i], at(i));
  });
  return record;
}

}  // namespace stilt::telemetry
