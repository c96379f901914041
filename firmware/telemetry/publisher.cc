#include "firmware/telemetry/publisher.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "firmware/diagnostics/event_text.h"
#include "firmware/robots/robots.h"
#include "firmware/telemetry/cycle_message.h"
#include "firmware/telemetry/histogram_message.h"
#include "firmware/telemetry/secret.h"
#include "firmware/telemetry/sequence.h"
#include "firmware/telemetry/wire_version.h"

namespace stilt::telemetry {
namespace {

template <class T>
bool open_writer(const Participant& participant, const Topic& topic, Writer<T>& writer, std::string& error) {
  auto opened = AnyWriter::open(participant, topic);
  if (opened) {
    writer = Writer<T>(std::move(*opened));
  } else {
    error = opened.error();
  }
  return error.empty();
}

/// Of Event_: 4 and 5 are telemetry's own.
std::uint8_t wire_kind(control_loop::Event::Kind kind) noexcept {
  const auto number = static_cast<std::uint8_t>(kind);
  return number < 4 ? number : static_cast<std::uint8_t>(number + 2);
}

std::string sentence_of(const control_loop::Event& event) {
  switch (event.kind) {
    case control_loop::Event::Kind::state:
      return supervisor::name(event.state);
    case control_loop::Event::Kind::fault: {
      const supervisor::FaultRow& row = supervisor::row(event.fault);
      return std::string(row.cause) + diagnostics::found_text(event.found) + "; clears when " + row.clears;
    }
    case control_loop::Event::Kind::bring_up_failed:
      return diagnostics::bring_up_text(event.bring_up);
    case control_loop::Event::Kind::fault_over:
      return std::string(supervisor::name(event.fault)) + diagnostics::over_text(event.fault);
    case control_loop::Event::Kind::waits_for_pose:
    case control_loop::Event::Kind::lost_stance:
    case control_loop::Event::Kind::stopped_waiting:
      return diagnostics::pose_text(event);
  }
  return {};
}

std::string name_of(const control_loop::Event& event) {
  switch (event.kind) {
    case control_loop::Event::Kind::state:
      return supervisor::name(event.state);
    case control_loop::Event::Kind::fault:
    case control_loop::Event::Kind::fault_over:
      return supervisor::name(event.fault);
    case control_loop::Event::Kind::waits_for_pose:
      return "waits_for_pose";
    case control_loop::Event::Kind::bring_up_failed:
      return "bring_up_failed";
    case control_loop::Event::Kind::lost_stance:
      return "lost_stance";
    case control_loop::Event::Kind::stopped_waiting:
      return "stopped_waiting";
  }
  return {};
}

/// What a fault, a bring-up or a pose found.
void set_found(const control_loop::Event& event, Event& message) noexcept {
  const bool bring_up = event.kind == control_loop::Event::Kind::bring_up_failed;
  const supervisor::FaultDetail& found = event.found;
  message.joint = bring_up ? static_cast<std::int32_t>(event.bring_up.joint) : found.joint;
  message.driver_fault = static_cast<std::uint8_t>(bring_up ? event.bring_up.fault : found.driver_fault);
  message.driver_fault_code = bring_up ? event.bring_up.fault_code : found.fault_code;
  message.value = found.value;
  message.limit = found.limit;
  message.bring_up_failure = static_cast<std::uint8_t>(event.bring_up.failure);
  message.driver_setting = static_cast<std::uint8_t>(event.bring_up.setting);
  message.bus = found.bus;
  const control_loop::PoseMiss& pose = event.pose;
  if (pose.none()) return;
  message.joint = pose.joint == control_loop::PoseMiss::kTorso ? -1 : pose.joint;
  message.value = pose.value;
  message.limit = pose.value < pose.lowest ? pose.lowest : pose.highest;
}

/// Numbers of a preview, as the message holds them.
struct PreviewNumbers {
  std::vector<float> time_s, base, joints, feet, forces, torques;
  std::vector<std::uint8_t> contact;

  void add(const control_loop::PlanPreview::Node& node, double start_time_s, const ocp::ProblemData& data) {
    model::KinematicsTerms<double> feet_terms;
    data.robot->kinematics(node.state.data(), feet_terms);
    model::NodeTerms<double> terms;
    data.robot->node(node.state.data(), node.input.data(), data.joint_parameters, terms);
    time_s.push_back(static_cast<float>(node.time_s - start_time_s));
    contact.push_back(static_cast<std::uint8_t>((node.mode[0] ? 1 : 0) + (node.mode[1] ? 2 : 0)));
    for (int i = 0; i < model::kFirstJoint; ++i) base.push_back(static_cast<float>(node.state[i]));
    for (int i = 0; i < model::kJoints; ++i) {
      joints.push_back(static_cast<float>(node.state[model::kFirstJoint + i]));
      feet.push_back(static_cast<float>(feet_terms.foot_position[i]));
      forces.push_back(static_cast<float>(node.input[model::kJoints + i]));
      torques.push_back(static_cast<float>(terms.joint_torque[i]));
    }
  }
};

}  // namespace

std::expected<Publisher, std::string> Publisher::open(const Participant& participant, std::uint64_t run_id) {
  Publisher made;
  made.run_id_ = run_id;
  std::string error;
  const bool opened = open_writer(participant, kTicks, made.ticks_, error) &&
                      open_writer(participant, kPlannerCycles, made.cycles_, error) &&
                      open_writer(participant, kPlans, made.plans_, error) &&
                      open_writer(participant, kSupervisor, made.supervisor_, error) &&
                      open_writer(participant, kEvents, made.events_writer_, error) &&
                      open_writer(participant, kTiming, made.timing_, error) &&
                      open_writer(participant, kConfiguration, made.configuration_, error) &&
                      open_writer(participant, kTuning, made.tuning_, error) &&
                      open_writer(participant, kCommandReplies, made.replies_, error);
  if (!opened) return std::unexpected(error);
  return made;
}

void Publisher::configuration(const configuration::Configuration& configuration, const RunDescription& run,
                              const Tuner& tuner, const WallTime& time) {
  RunDescription texts = run;
  std::string robot = configuration.hardware.robot;
  const auto description = robots::find(robot);
  std::string urdf = description ? (*description)->urdf : "";
  std::string toml =
      configuration::to_toml(configuration, "Active configuration, from " + run.configuration_source + ".");
  std::vector<std::array<std::string, 3>> words;
  for (const auto& tunable : tuner.tunables()) {
    words.push_back(
        {tunable.entry->name(), std::string(tunable.entry->unit), std::string(tunable.entry->description)});
  }
  std::vector<stilt_msgs_msg_dds__Tunable_> tunables;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& tunable = tuner.tunables()[i];
    tunables.push_back({words[i][0].data(), words[i][1].data(), words[i][2].data(), tunable.minimum,
                        tunable.maximum, tunable.start_value});
  }
  ActiveConfiguration message{};
  message.run_id = run_id_;
  set_view(message.robot, robot);
  set_view(message.configuration, toml);
  set_view(message.version, texts.version);
  set_view(message.compiler, texts.compiler);
  set_view(message.instruction_set, texts.instruction_set);
  message.start_time_ns = time.start_time_ns;
  message.start_clock_ns = time.start_clock_ns;
  message.lockstep = run.lockstep;
  set_view(message.realtime, texts.not_realtime);
  message.torque_rate_hz = configuration.timing.torque_rate_hz;
  message.plan_rate_hz = configuration.timing.plan_rate_hz;
  set_view(message.token_file, texts.token_file);
  set_view(message.tunables, tunables);
  message.wire_version = kWireVersion;
  set_view(message.urdf, urdf);
  configuration_.write(message);
}

void Publisher::tuning(const Tuner& tuner, const std::string& key, const std::string& commander) {
  std::string key_text = key;
  std::string who = commander;
  std::vector<double> values = tuner.values();
  Tuning message{};
  message.run_id = run_id_;
  message.number = tuner.number();
  set_view(message.key, key_text);
  set_view(message.commander, who);
  set_view(message.values, values);
  tuning_.write(message);
}

void Publisher::cycle(const control_loop::CycleRecord& record, const Drops& drops) {
  PlannerCycle message = cycle_message(record);
  message.run_id = run_id_;
  message.dropped = drops.cycles;
  cycles_.write(message);
}

void Publisher::plan(const control_loop::PlanPreview& preview, const control::PlannerSettings& settings) {
  PreviewNumbers numbers;
  for (int k = 0; k < preview.count; ++k) {
    numbers.add(preview.node[static_cast<std::size_t>(k)], preview.start_time_s, settings.data);
  }
  Plan message{};
  message.run_id = run_id_;
  message.plan_sequence = preview.sequence;
  message.start_time_s = preview.start_time_s;
  message.count = static_cast<std::uint32_t>(preview.count);
  set_view(message.time_s, numbers.time_s);
  set_view(message.contact, numbers.contact);
  set_view(message.base, numbers.base);
  set_view(message.joint_position_rad, numbers.joints);
  set_view(message.foot_position_m, numbers.feet);
  set_view(message.contact_force_N, numbers.forces);
  set_view(message.joint_torque_Nm, numbers.torques);
  plans_.write(message);
}

void Publisher::supervisor(const control_loop::TickRecord& tick, const WallTime& time,
                           const InCommand& in_command, double base_height_m,
                           const diagnostics::FoundWords& found) {
  std::string commander = in_command.name;
  Texts faults;
  Texts words;
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    if (!tick.present.has(row.fault) && !tick.latched.has(row.fault)) continue;
    faults.add(row.name);
    words.add(found[static_cast<std::size_t>(row.fault)]);
  }
  Supervisor message{};
  message.run_id = run_id_;
  message.tick = tick.tick;
  message.time_ns = tick.time_ns;
  message.time_s = time.seconds(tick.time_ns);
  message.state = static_cast<std::uint8_t>(tick.state);
  message.fallback_level = static_cast<std::uint8_t>(tick.level);
  message.reaction = static_cast<std::uint8_t>(tick.reaction);
  message.present_faults = tick.present.bits();
  message.latched_faults = tick.latched.bits();
  message.ramp = tick.ramp;
  message.request_kind = static_cast<std::uint8_t>(tick.command.request.kind);
  message.request_number = tick.command.request.number;
  message.request_speed_m_s = tick.command.request.speed_m_s;
  message.base_height_m = base_height_m;
  message.gait = static_cast<std::uint8_t>(tick.gait.kind);
  message.speed_m_s = tick.gait.speed_m_s;
  set_view(message.commander, commander);
  message.commander_alive = in_command.alive;
  set_view(message.state_name, supervisor::name(tick.state));
  set_view(message.fallback_level_name, supervisor::name(tick.level));
  faults.set_view_in(message.faults);
  words.set_view_in(message.found);
  supervisor_.write(message);
}

void Publisher::send(Event& event, const Drops& drops) {
  event.run_id = run_id_;
  event.number = events_++;
  event.dropped = drops.events;
  events_writer_.write(event);
}

void Publisher::event(const control_loop::Event& event, const Drops& drops) {
  std::string name = name_of(event);
  std::string text = sentence_of(event);
  Event message{};
  message.time_s = event.time_s;
  message.kind = wire_kind(event.kind);
  message.state = static_cast<std::uint8_t>(event.state);
  message.fault = static_cast<std::uint8_t>(event.fault);
  if (event.kind == control_loop::Event::Kind::fault) {
    message.reaction = static_cast<std::uint8_t>(supervisor::row(event.fault).reaction);
  }
  set_found(event, message);
  set_view(message.name, name);
  set_view(message.text, text);
  send(message, drops);
}

void Publisher::note(std::uint8_t kind, double time_s, const std::string& name, const std::string& text,
                     const Drops& drops) {
  std::string its_name = name;
  std::string its_text = text;
  Event message{};
  message.time_s = time_s;
  message.kind = kind;
  set_found({}, message);
  set_view(message.name, its_name);
  set_view(message.text, its_text);
  send(message, drops);
}

void Publisher::timing(const diagnostics::LoopStatistics& loop,
                       const diagnostics::PlannerStatistics& planning,
                       const configuration::Configuration& configuration, double time_s, const Drops& drops) {
  const double tick_us = 1e6 / configuration.timing.torque_rate_hz;
  std::array<HistogramMessage, 4> histograms = {
      HistogramMessage("wakeup_latency", loop.wakeup_latency,
                       1e6 * configuration.supervisor.torque_loop_overrun_s),
      HistogramMessage("execution", loop.execution, tick_us),
      HistogramMessage("bus_round_trip", loop.bus_round_trip, tick_us),
      HistogramMessage("solve", planning.solve, 1e6 * configuration.supervisor.planner_overrun_s)};
  std::vector<stilt_msgs_msg_dds__Histogram_> list;
  list.reserve(histograms.size());
  for (HistogramMessage& histogram : histograms) list.push_back(histogram.message());
  Timing message{};
  message.run_id = run_id_;
  message.time_s = time_s;
  message.ticks = static_cast<std::uint64_t>(loop.ticks);
  message.late_ticks = static_cast<std::uint64_t>(loop.late_ticks);
  message.missed_periods = static_cast<std::uint64_t>(loop.missed_periods);
  message.plans = static_cast<std::uint64_t>(planning.plans);
  message.heap_allocations = static_cast<std::uint64_t>(loop.heap_allocations + planning.heap_allocations);
  message.page_faults = static_cast<std::uint64_t>(loop.page_faults + planning.page_faults);
  message.dropped_ticks = drops.ticks;
  message.dropped_cycles = drops.cycles;
  message.dropped_events = drops.events;
  set_view(message.histograms, list);
  timing_.write(message);
}

void Publisher::reply(std::string_view token, const std::string& commander, std::uint64_t number,
                      bool accepted, const std::string& reason, double time_s) {
  std::string who = commander;
  std::string why = reason;
  std::string proven = proof(token, ReplyText{run_id_, who, number, accepted, why, time_s});
  CommandReply message{};
  message.run_id = run_id_;
  set_view(message.commander, who);
  message.number = number;
  message.accepted = accepted;
  set_view(message.reason, why);
  message.time_s = time_s;
  set_view(message.proof, proven);
  replies_.write(message);
}

void Publisher::ticks(TickBatchBuilder& batch, const Drops& drops) {
  batch.message().run_id = run_id_;
  batch.message().dropped = drops.ticks;
  ticks_.write(batch.message());
}

bool Publisher::flush(double longest_s) {
  using std::chrono::steady_clock;
  const auto end = steady_clock::now() + std::chrono::duration<double>(longest_s);
  const auto has_arrived = [&](const auto& writer) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(end - steady_clock::now());
    return writer.wait_for_acks(std::max(left, std::chrono::nanoseconds(0)));
  };
  return has_arrived(ticks_) && has_arrived(cycles_) && has_arrived(events_writer_) &&
         has_arrived(configuration_) && has_arrived(tuning_) && has_arrived(replies_);
}

}  // namespace stilt::telemetry
