#pragma once

#include <cstdint>
#include <string>

#include "firmware/telemetry/reader.h"
#include "host_tools/telemetry/simulation_publisher.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// Turns messages of stiltd into samples, whether they come from the network or a record: keeps to one
/// run, the one that started last, and knows its clock, its tunables and their values.
class MessageDecoder {
 public:
  /// Passes on what is in the message; nothing for topics that a monitor does not show, and for bytes that
  /// are no message.
  void take(const telemetry::Sample& message, SampleSink& sink);

  /// Run of the newest configuration; 0 before the first.
  [[nodiscard]] std::uint64_t run_id() const { return run_id_; }

  /// Where the run's token is, as stiltd says; empty before its configuration came.
  [[nodiscard]] const std::string& token_file() const { return token_file_; }

  /// Samples left out because they are of another run, while this one talks, too.
  [[nodiscard]] std::uint64_t of_others() const { return of_others_; }

 private:
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
  std::uint64_t unknown_run_samples_ = 0;  ///< of another run, since the newest sample of this one
};

}  // namespace stilt::monitor
