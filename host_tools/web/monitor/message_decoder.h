#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "firmware/telemetry/reader.h"
#include "host_tools/telemetry/simulation_publisher.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// Which of several runs a decoder follows.
enum class Follow {
  newest,   ///< the one that started last: runs of a record come one after the other
  sending,  ///< the first one, for as long as it sends; then another that sends
};

/// A run whose configuration is known.
struct KnownRun {
  std::uint64_t run_id = 0;
  std::string robot;
  std::string token_file;  ///< as stiltd names it
  bool sends = false;      ///< whether ticks of it come
};

/// A number of a run as text: "001085a41154fb89".
[[nodiscard]] std::string run_text(std::uint64_t run_id);

/// Converts messages of stiltd to samples, from the network or from a record. Follows one run, with its
/// clock, its tunables and their values. One thread.
class MessageDecoder {
 public:
  /// Batches of ticks of other runs without one of a run in between, after which that run is silent: 2.5 s at
  /// the shipped rates.
  static constexpr std::uint64_t kSilentBatches = 100;

  explicit MessageDecoder(Follow follow = Follow::sending) : follow_(follow) {}

  /// Passes the content of the message to `sink`. Ignores topics that a monitor does not show, and bytes that
  /// are not a message. Also ignores messages with a number that its enumeration does not have. A run whose
  /// messages have another wire version is not followed; one event states it. So does one when ticks come
  /// without the configuration of their run.
  void take(const telemetry::Sample& message, SampleSink& sink);

  /// Follows another known run from now on, for as long as it sends.
  void choose(std::uint64_t run_id, SampleSink& sink);

  /// All runs whose configuration is known, oldest first.
  [[nodiscard]] std::vector<KnownRun> runs() const;

  /// The run that is followed; 0 before the first configuration.
  [[nodiscard]] std::uint64_t run_id() const { return run_id_; }

  /// Samples left out because they are of another run, while the one that is followed sends.
  [[nodiscard]] std::uint64_t of_others() const { return of_others_; }

  /// Why the newest run whose messages cannot be read is not followed: the text of its event. Empty when
  /// there is none, or another run's configuration came after it.
  [[nodiscard]] const std::string& refused() const { return refused_; }

 private:
  /// What is kept of a run, to follow it later.
  struct Run {
    std::uint64_t run_id = 0;
    telemetry::Sample configuration;
    std::optional<telemetry::Sample> tuning;
    std::uint64_t batches_ago = 0;  ///< batches of ticks of all runs since its last sample
  };

  struct EventsOfRun {
    std::uint64_t run_id = 0;
    std::deque<telemetry::Sample> events;  ///< the newest, oldest first
  };

  /// A run whose messages cannot be read.
  struct Refused {
    std::uint64_t run_id = 0;
    std::string text;  ///< of its event
  };

  /// Keeps an event, also of a run whose configuration is not known yet: both last, and either may come
  /// first.
  void keep_event(std::uint64_t run_id, const telemetry::Sample& message);
  /// States once that a run's messages cannot be read.
  void refuse(std::uint64_t run_id, const std::string& sentence, SampleSink& sink);
  /// Refuses a run whose ticks come without a configuration for two seconds.
  void expect_configuration(const telemetry::Sample& message, SampleSink& sink);
  void configure(const telemetry::Sample& message, SampleSink& sink);
  void follow(const Run& run, SampleSink& sink);
  [[nodiscard]] bool ours(std::uint64_t run_id, const telemetry::Sample& message, SampleSink& sink);
  void tune(const telemetry::Tuning& message, SampleSink& sink);
  void ticks(const telemetry::TickBatch& batch, SampleSink& sink);
  void truth(const host_telemetry::SimulationMessage& message, SampleSink& sink) const;
  [[nodiscard]] Run* known(std::uint64_t run_id);

  template <class Message, class Use>
  void take_as(const telemetry::Sample& message, SampleSink& sink, Use use);

  Follow follow_;
  std::vector<Run> runs_;
  std::deque<EventsOfRun> events_;             ///< one entry per run, in the order of their first events
  std::deque<telemetry::Sample> of_next_run_;  ///< of other runs, since the last sample of the followed one
  std::uint64_t run_id_ = 0;
  std::int64_t run_start_ns_ = 0;
  std::int64_t clock_start_ns_ = 0;
  ConfigurationSample configuration_;
  double newest_tick_s_ = 0.0;
  std::uint64_t of_others_ = 0;
  std::uint64_t unconfigured_ticks_ = 0;  ///< of unknown runs, since the last configuration
  std::deque<Refused> refused_runs_;      ///< the newest, each with one event
  std::string refused_;
};

}  // namespace stilt::monitor
