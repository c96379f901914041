#include "host_tools/web/monitor/message_decoder.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "firmware/robots/robots.h"
#include "firmware/telemetry/tick_batch.h"
#include "host_tools/telemetry/wire_version.h"
#include "host_tools/web/monitor/message_samples.h"

namespace stilt::monitor {
namespace {

/// Samples of other runs that are kept until one of them is followed, and runs that are kept.
constexpr std::size_t kMostWaiting = 4096;
constexpr std::size_t kMostRuns = 16;
/// Of each run, as many as stiltd keeps for a late reader.
constexpr std::size_t kMostEvents = 256;
/// Two seconds. The configuration of a run comes with its first ticks, also to a monitor that starts later.
constexpr std::uint64_t kTicksWithoutConfiguration = 2000;

}  // namespace

std::string run_text(std::uint64_t run_id) {
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(run_id));
  return digits;
}

MessageDecoder::Run* MessageDecoder::known(std::uint64_t run_id) {
  const auto found = std::ranges::find(runs_, run_id, &Run::run_id);
  return found == runs_.end() ? nullptr : &*found;
}

std::vector<KnownRun> MessageDecoder::runs() const {
  std::vector<KnownRun> all;
  for (const Run& run : runs_) {
    const auto message = run.configuration.as<telemetry::ActiveConfiguration>();
    all.push_back({run.run_id, message->robot, message->token_file, run.batches_ago < kSilentBatches});
  }
  return all;
}

void MessageDecoder::keep_event(std::uint64_t run_id, const telemetry::Sample& message) {
  auto found = std::ranges::find(events_, run_id, &EventsOfRun::run_id);
  if (found == events_.end()) {
    if (events_.size() == kMostRuns) {
      events_.erase(
          std::ranges::find_if(events_, [this](const EventsOfRun& one) { return one.run_id != run_id_; }));
    }
    found = events_.insert(events_.end(), {run_id, {}});
  }
  found->events.push_back(message);
  if (found->events.size() > kMostEvents) found->events.pop_front();
}

/// Whether a message is of the run that is followed. One of another run waits: perhaps that one is followed
/// next, and then nothing of it is missing.
bool MessageDecoder::ours(std::uint64_t run_id, const telemetry::Sample& message, SampleSink& sink) {
  const bool batch = message.topic == &telemetry::kTicks;
  for (Run& run : runs_) {
    if (batch) ++run.batches_ago;
    if (run.run_id != run_id) continue;
    run.batches_ago = 0;
    if (message.topic == &telemetry::kTuning) run.tuning = message;
  }
  const bool event = message.topic == &telemetry::kEvents;
  if (event) keep_event(run_id, message);
  if (run_id_ == 0) return false;
  if (run_id == run_id_) {
    of_others_ += of_next_run_.size();
    of_next_run_.clear();
    return true;
  }
  if (event) return false;
  of_next_run_.push_back(message);
  if (of_next_run_.size() > kMostWaiting) of_next_run_.pop_front();
  const Run* other = known(run_id);
  const bool silent = known(run_id_)->batches_ago >= kSilentBatches;
  if (follow_ == Follow::sending && batch && silent && other != nullptr) follow(*other, sink);
  return false;
}

template <class Message, class Use>
void MessageDecoder::take_as(const telemetry::Sample& message, SampleSink& sink, Use use) {
  const auto decoded = message.as<Message>();
  if (decoded && ours(decoded->run_id, message, sink)) use(*decoded);
}

void MessageDecoder::take(const telemetry::Sample& message, SampleSink& sink) {
  const telemetry::Topic* topic = message.topic;
  if (topic == &telemetry::kConfiguration) {
    configure(message, sink);
  } else if (topic == &telemetry::kTuning) {
    take_as<telemetry::Tuning>(message, sink, [&](const auto& tuning) { tune(tuning, sink); });
  } else if (topic == &telemetry::kTicks) {
    expect_configuration(message, sink);
    take_as<telemetry::TickBatch>(message, sink, [&](const auto& batch) { ticks(batch, sink); });
  } else if (topic == &telemetry::kPlannerCycles) {
    take_as<telemetry::PlannerCycle>(message, sink, [&](const auto& cycle) {
      if (well_formed(cycle)) sink.planner(planner_sample(cycle));
    });
  } else if (topic == &telemetry::kPlans) {
    take_as<telemetry::Plan>(message, sink, [&](const auto& plan) { sink.plan(plan_sample(plan)); });
  } else if (topic == &telemetry::kSupervisor) {
    take_as<telemetry::Supervisor>(message, sink, [&](const auto& state) {
      if (well_formed(state)) sink.supervisor(supervisor_sample(state));
    });
  } else if (topic == &telemetry::kEvents) {
    take_as<telemetry::Event>(message, sink, [&](const auto& event) { sink.event(event_sample(event)); });
  } else if (topic == &host_telemetry::kSimulation) {
    if (const auto decoded = message.as<host_telemetry::SimulationMessage>()) truth(*decoded, sink);
  } else if (topic == &telemetry::kTiming) {
    take_as<telemetry::Timing>(message, sink,
                               [&](const auto& timing) { sink.timing(timing_sample(timing)); });
  }
}

void MessageDecoder::refuse(std::uint64_t run_id, const std::string& sentence, SampleSink& sink) {
  auto found = std::ranges::find(refused_runs_, run_id, &Refused::run_id);
  if (found == refused_runs_.end()) {
    if (refused_runs_.size() == kMostRuns) refused_runs_.pop_front();
    found = refused_runs_.insert(refused_runs_.end(), {run_id, "run " + run_text(run_id) + " " + sentence});
    sink.event({.time_s = newest_tick_s_, .text = found->text, .serious = true});
  }
  refused_ = found->text;
}

void MessageDecoder::expect_configuration(const telemetry::Sample& message, SampleSink& sink) {
  const auto batch = message.as<telemetry::TickBatch>();
  if (!batch || !telemetry::well_formed(*batch) || known(batch->run_id) != nullptr) return;
  unconfigured_ticks_ += batch->count;
  if (unconfigured_ticks_ < kTicksWithoutConfiguration) return;
  refuse(
      batch->run_id,
      "sends ticks but no configuration that this stilt can read, as release 0.1 does; use the stilt of the "
      "same release as stiltd",
      sink);
}

void MessageDecoder::configure(const telemetry::Sample& message, SampleSink& sink) {
  const auto decoded = message.as<telemetry::ActiveConfiguration>();
  if (!decoded || known(decoded->run_id) != nullptr) return;
  if (const auto problem = host_telemetry::wire_version_problem(decoded->wire_version)) {
    refuse(decoded->run_id, *problem, sink);
    return;
  }
  unconfigured_ticks_ = 0;
  refused_.clear();
  if (runs_.size() == kMostRuns) {
    runs_.erase(std::ranges::max_element(
        runs_, {}, [this](const Run& run) { return std::pair(run.run_id != run_id_, run.batches_ago); }));
  }
  const Run& run = runs_.emplace_back(Run{decoded->run_id, message, {}});
  const bool newer = decoded->start_time_ns >= run_start_ns_;
  if (run_id_ == 0 || (follow_ == Follow::newest && newer)) follow(run, sink);
}

void MessageDecoder::choose(std::uint64_t run_id, SampleSink& sink) {
  const Run* run = known(run_id);
  if (run != nullptr && run_id != run_id_) follow(*run, sink);
}

void MessageDecoder::follow(const Run& run, SampleSink& sink) {
  const auto message = run.configuration.as<telemetry::ActiveConfiguration>();
  run_id_ = message->run_id;
  run_start_ns_ = message->start_time_ns;
  clock_start_ns_ = message->start_clock_ns;
  static_cast<void>(robots::of_run(message->robot, message->urdf));  // for drawing; its file may be elsewhere
  configuration_ = configuration_sample(*message);
  configuration_.run_id = run_text(run_id_);
  const auto tuning = run.tuning;
  sink.configuration(configuration_);
  if (tuning) tune(*tuning->as<telemetry::Tuning>(), sink);
  const auto before = std::ranges::find(events_, run_id_, &EventsOfRun::run_id);
  if (before != events_.end()) {
    for (const telemetry::Sample& event : before->events) {
      sink.event(event_sample(*event.as<telemetry::Event>()));
    }
  }
  const std::deque<telemetry::Sample> waiting = std::exchange(of_next_run_, {});
  for (const telemetry::Sample& sample : waiting) take(sample, sink);
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
  for (std::size_t k = 0; k < batch.count; ++k) {
    TickSample sample{0.0, telemetry::tick_record(batch, k), configuration_.tick_rate_hz};
    sample.time_s = 1e-9 * static_cast<double>(sample.record.time_ns - clock_start_ns_);
    newest_tick_s_ = sample.time_s;
    sink.tick(sample);
  }
}

}  // namespace stilt::monitor
