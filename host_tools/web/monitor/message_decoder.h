#pragma once

#include <cstdint>
#include <string>

#include "firmware/telemetry/reader.h"
#include "host_tools/telemetry/simulation_publisher.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// Converts messages of stiltd to samples, from the network or from a record. Follows the run that started
/// last, with its clock, its tunables and their values.
class MessageDecoder {
 public:
  /// Passes the content of the message to `sink`. Ignores topics that a monitor does not show, and bytes that
  /// are not a message. A run whose messages have another wire version is not followed; one event states it,
  /// and so does one when ticks come without the configuration of their run.
  void take(const telemetry::Sample& message, SampleSink& sink);

  /// Run of the newest configuration; 0 before the first.
  [[nodiscard]] std::uint64_t run_id() const { return run_id_; }

  /// Path of the run's token file, reported by stiltd; empty before its configuration is received.
  [[nodiscard]] const std::string& token_file() const { return token_file_; }

  /// Samples ignored because they are of another run that is also publishing.
  [[nodiscard]] std::uint64_t of_others() const { return of_others_; }

 private:
  void refuse(const std::string& sentence, SampleSink& sink) const;
  void configure(const telemetry::ConfigurationInForce& message, SampleSink& sink);
  void tune(const telemetry::Tuning& message, SampleSink& sink);
  void ticks(const telemetry::TickBatch& batch, SampleSink& sink);
  void truth(const host_telemetry::SimulationMessage& message, SampleSink& sink) const;
  [[nodiscard]] bool ours(std::uint64_t run_id);

  template <class Message, class Use>
  void take_as(const telemetry::Sample& message, Use use);

  std::uint64_t run_id_ = 0;
  std::int64_t run_start_ns_ = 0;
  std::int64_t clock_start_ns_ = 0;
  std::string token_file_;
  ConfigurationSample configuration_;
  double newest_tick_s_ = 0.0;
  std::uint64_t of_others_ = 0;
  std::uint64_t unknown_run_samples_ = 0;  ///< messages of another run, since the last one of this run
  std::uint64_t unknown_run_ticks_ = 0;    ///< likewise ticks
  std::uint64_t refused_run_ = 0;          ///< has messages of another wire version
};

}  // namespace stilt::monitor
