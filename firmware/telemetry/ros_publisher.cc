#include "firmware/telemetry/ros_publisher.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <vector>

#include "firmware/control_loop/joint_names.h"
#include "firmware/telemetry/sequence.h"
#include "mpc_core/model/types.h"

namespace stilt::telemetry {
namespace {

using control_loop::kJointNames;
using control_loop::TickRecord;

/// Levels of diagnostic_msgs/DiagnosticStatus.
constexpr std::uint8_t kOk = 0, kWarning = 1, kError = 2;

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  return digits;
}
std::string text(long long value) { return std::to_string(value); }

/// A status and the texts that it points to.
struct Status {
  std::uint8_t level = kOk;
  std::string name;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// The message of many of them; lives as long as the write.
class Array {
 public:
  void add(Status status) { statuses_.push_back(std::move(status)); }

  DiagnosticArray& message(const builtin_interfaces_msg_dds__Time_& stamp, std::string& hardware) {
    for (Status& status : statuses_) {
      pairs_.emplace_back();
      for (auto& [key, value] : status.values) pairs_.back().push_back({key.data(), value.data()});
      diagnostic_msgs_msg_dds__DiagnosticStatus_ entry{};
      entry.level = status.level;
      set_view(entry.name, status.name);
      set_view(entry.message, status.message);
      set_view(entry.hardware_id, hardware);
      set_view(entry.values, pairs_.back());
      entries_.push_back(entry);
    }
    message_.header.stamp = stamp;
    set_view(message_.header.frame_id, "");
    set_view(message_.status, entries_);
    return message_;
  }

 private:
  std::vector<Status> statuses_;
  std::deque<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> pairs_;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> entries_;
  DiagnosticArray message_{};
};

Status supervisor_status(const TickRecord& tick, const diagnostics::FoundWords& found) {
  Status status{
      .level = kOk, .name = "stiltd: supervisor", .message = supervisor::name(tick.state), .values = {}};
  if (tick.reaction != supervisor::Reaction::none) {
    status.level = tick.reaction == supervisor::Reaction::warn ? kWarning : kError;
  }
  status.values = {{"fallback_level", supervisor::name(tick.level)},
                   {"reaction", supervisor::name(tick.reaction)}};
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    const bool present = tick.present.has(row.fault);
    if (!present && !tick.latched.has(row.fault)) continue;
    const std::string& words = found[static_cast<std::size_t>(row.fault)];
    const std::string by = words.empty() ? "" : ": " + words;
    status.message += std::string("; ") + row.cause + by;
    status.values.emplace_back(row.name, (present ? "present" : "waits for a reset") + by);
  }
  return status;
}

Status timing_status(const diagnostics::LoopStatistics& loop,
                     const diagnostics::PlannerStatistics& planning) {
  const long long allocations = loop.heap_allocations + planning.heap_allocations;
  const long long faults = loop.page_faults + planning.page_faults;
  Status status{.level = kOk, .name = "stiltd: timing", .message = "in time", .values = {}};
  if (loop.late_ticks > 0) {
    status.level = kWarning;
    status.message = text(loop.late_ticks) + " late ticks";
  }
  status.values = {{"ticks", text(loop.ticks)},
                   {"late_ticks", text(loop.late_ticks)},
                   {"missed_periods", text(loop.missed_periods)},
                   {"plans", text(planning.plans)},
                   {"heap_allocations", text(allocations)},
                   {"page_faults", text(faults)},
                   {"wakeup_latency_p99_us", text(loop.wakeup_latency.percentile_us(0.99))},
                   {"execution_p99_us", text(loop.execution.percentile_us(0.99))},
                   {"solve_p99_us", text(planning.solve.percentile_us(0.99))}};
  return status;
}

/// The estimate has no place of the base without a foot on the ground, and no pitch before the first reading.
bool has_base(const TickRecord& tick) {
  const double* q = tick.estimated_state.data();
  const double* v = q + model::kPositions;
  const auto finite = [](double value) { return std::isfinite(value); };
  return tick.stance_episode != 0 && std::all_of(q, q + model::kFirstJoint, finite) &&
         std::all_of(v, v + model::kFirstJoint, finite);
}

Status driver_status(const hal::JointReading& joint, std::size_t index) {
  Status status{
      .level = kOk, .name = std::string("driver: ") + kJointNames[index], .message = "", .values = {}};
  status.message = hal::name(joint.fault);
  if (joint.fault == hal::DriverFault::none) status.message = "no fault";
  if (joint.fault != hal::DriverFault::none || joint.state == hal::DriverState::fault) status.level = kError;
  status.values = {{"temperature_C", text(joint.driver_temperature_C)},
                   {"motor_temperature_C", text(joint.motor_temperature_C)},
                   {"supply_V", text(joint.supply_V)},
                   {"missed_replies", text(static_cast<long long>(joint.missed_replies))},
                   {"fault_code", text(static_cast<long long>(joint.fault_code))}};
  return status;
}

}  // namespace

std::expected<RosPublisher, std::string> RosPublisher::open(const Participant& participant) {
  RosPublisher made;
  auto joint_states = AnyWriter::open(participant, kJointStates);
  auto odometry = AnyWriter::open(participant, kOdometry);
  auto diagnostics = AnyWriter::open(participant, kDiagnostics);
  for (const auto* writer : {&joint_states, &odometry, &diagnostics}) {
    if (!*writer) return std::unexpected(writer->error());
  }
  made.joint_states_ = Writer<JointState>(std::move(*joint_states));
  made.odometry_ = Writer<Odometry>(std::move(*odometry));
  made.diagnostics_ = Writer<DiagnosticArray>(std::move(*diagnostics));
  return made;
}

void RosPublisher::joint_states(const TickRecord& tick, const WallTime& time) {
  JointState message{};
  Texts names;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> effort;
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    names.add(kJointNames[i]);
    position.push_back(tick.joints[i].position_rad);
    velocity.push_back(tick.joints[i].velocity_rad_s);
    effort.push_back(tick.joints[i].torque_Nm);
  }
  message.header.stamp = time.stamp(tick.time_ns);
  set_view(message.header.frame_id, "");
  names.set_view_in(message.name);
  set_view(message.position, position);
  set_view(message.velocity, velocity);
  set_view(message.effort, effort);
  joint_states_.write(message);
}

void RosPublisher::odometry(const TickRecord& tick, const WallTime& time) {
  if (!has_base(tick)) return;
  const double* q = tick.estimated_state.data();
  const double* v = q + model::kPositions;
  const double cosine = std::cos(q[2]);
  const double sine = std::sin(q[2]);
  Odometry message{};
  message.header.stamp = time.stamp(tick.time_ns);
  set_view(message.header.frame_id, "odom");
  set_view(message.child_frame_id, "base");
  message.pose.pose.position = {q[0], 0.0, q[1]};
  message.pose.pose.orientation = {0.0, std::sin(0.5 * q[2]), 0.0, std::cos(0.5 * q[2])};
  message.twist.twist.linear = {cosine * v[0] - sine * v[1], 0.0, sine * v[0] + cosine * v[1]};
  message.twist.twist.angular = {0.0, v[2], 0.0};
  odometry_.write(message);
}

void RosPublisher::diagnostics(const TickRecord& tick, const diagnostics::LoopStatistics& loop,
                               const diagnostics::PlannerStatistics& planning, const WallTime& time,
                               const std::string& robot, const diagnostics::FoundWords& found) {
  Array array;
  array.add(supervisor_status(tick, found));
  array.add(timing_status(loop, planning));
  for (std::size_t i = 0; i < hal::kJoints; ++i) array.add(driver_status(tick.joints[i], i));
  std::string hardware = robot;
  diagnostics_.write(array.message(time.stamp(tick.time_ns), hardware));
}

}  // namespace stilt::telemetry
