#include "host_tools/web/monitor/message_decoder.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "firmware/telemetry/tick_batch.h"
#include "host_tools/telemetry/wire_version.h"
#include "host_tools/web/monitor/message_samples.h"

namespace stilt::monitor {
namespace {

/// Two seconds. The configuration of a run comes with its first ticks, also to a monitor that starts later.
constexpr std::uint64_t kTicksWithoutConfiguration = 2000;

std::string run_text(std::uint64_t run_id) {
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(run_id));
  return digits;
}

}  // namespace

bool MessageDecoder::ours(std::uint64_t run_id) {
  if (run_id == run_id_ && run_id_ != 0) {
    of_others_ += unknown_run_samples_;
    unknown_run_samples_ = unknown_run_ticks_ = 0;
    return true;
  }
  if (run_id_ != 0) ++unknown_run_samples_;
  return false;
}

template <class Message, class Use>
void MessageDecoder::take_as(const telemetry::Sample& message, Use use) {
  const auto decoded = message.as<Message>();
  if (decoded && ours(decoded->run_id)) use(*decoded);
}

void MessageDecoder::take(const telemetry::Sample& message, SampleSink& sink) {
  const telemetry::Topic* topic = message.topic;
  if (topic == &telemetry::kConfiguration) {
    if (const auto decoded = message.as<telemetry::ConfigurationInForce>()) configure(*decoded, sink);
  } else if (topic == &telemetry::kTuning) {
    take_as<telemetry::Tuning>(message, [&](const auto& tuning) { tune(tuning, sink); });
  } else if (topic == &telemetry::kTicks) {
    if (const auto batch = message.as<telemetry::TickBatch>()) ticks(*batch, sink);
  } else if (topic == &telemetry::kPlannerCycles) {
    take_as<telemetry::PlannerCycle>(message,
                                     [&](const auto& cycle) { sink.planner(planner_sample(cycle)); });
  } else if (topic == &telemetry::kPlans) {
    take_as<telemetry::Plan>(message, [&](const auto& plan) { sink.plan(plan_sample(plan)); });
  } else if (topic == &telemetry::kSupervisor) {
    take_as<telemetry::Supervisor>(message,
                                   [&](const auto& state) { sink.supervisor(supervisor_sample(state)); });
  } else if (topic == &telemetry::kEvents) {
    take_as<telemetry::Event>(message, [&](const auto& event) { sink.event(event_sample(event)); });
  } else if (topic == &host_telemetry::kSimulation) {
    if (const auto decoded = message.as<host_telemetry::SimulationMessage>()) truth(*decoded, sink);
  } else if (topic == &telemetry::kTiming) {
    take_as<telemetry::Timing>(message, [&](const auto& timing) { sink.timing(timing_sample(timing)); });
  }
}

void MessageDecoder::refuse(const std::string& sentence, SampleSink& sink) const {
  sink.event({.time_s = newest_tick_s_, .text = sentence, .serious = true});
}

void MessageDecoder::configure(const telemetry::ConfigurationInForce& message, SampleSink& sink) {
  if (message.run_id == run_id_ || message.start_time_ns < run_start_ns_) return;
  if (const auto problem = host_telemetry::wire_version_problem(message.wire_version)) {
    if (message.run_id != refused_run_) refuse("run " + run_text(message.run_id) + " " + *problem, sink);
    refused_run_ = message.run_id;
    return;
  }
  run_id_ = message.run_id;
  run_start_ns_ = message.start_time_ns;
  clock_start_ns_ = message.start_clock_ns;
  token_file_ = message.token_file;
  unknown_run_samples_ = unknown_run_ticks_ = 0;
  configuration_ = configuration_sample(message);
  configuration_.run_id = run_text(run_id_);
  sink.configuration(configuration_);
}

void MessageDecoder::tune(const telemetry::Tuning& message, SampleSink& sink) {
  const auto values = telemetry::span_of(message.values);
  if (values.size() != configuration_.tunables.size()) return;
  for (std::size_t k = 0; k < values.size(); ++k) configuration_.tunables[k].value = values[k];
  sink.configuration(configuration_);
}

/// A simulated robot does not have the controller's clock: its data get the time of the newest tick.
void MessageDecoder::truth(const host_telemetry::SimulationMessage& message, SampleSink& sink) const {
  TruthSample sample;
  sample.time_s = newest_tick_s_;
  std::copy_n(static_cast<const double*>(message.contact_force_N), 4, sample.contact_force_N.begin());
  sample.push_N = message.push_N;
  sample.push_above_hip_m = message.push_above_hip_m;
  sink.truth(sample);
}

void MessageDecoder::ticks(const telemetry::TickBatch& batch, SampleSink& sink) {
  if (!telemetry::well_formed(batch)) return;
  if (!ours(batch.run_id)) {
    const std::uint64_t before = std::exchange(unknown_run_ticks_, unknown_run_ticks_ + batch.count);
    if (batch.run_id != refused_run_ && before < kTicksWithoutConfiguration &&
        unknown_run_ticks_ >= kTicksWithoutConfiguration) {
      refuse("run " + run_text(batch.run_id) +
                 " sends ticks but no configuration that this stilt can read, as release 0.1 does; use the "
                 "stilt "
                 "of the same release as stiltd",
             sink);
    }
    return;
  }
  for (std::size_t k = 0; k < batch.count; ++k) {
    TickSample sample{0.0, telemetry::tick_record(batch, k)};
    sample.time_s = 1e-9 * static_cast<double>(sample.record.time_ns - clock_start_ns_);
    newest_tick_s_ = sample.time_s;
    sink.tick(sample);
  }
}

}  // namespace stilt::monitor
