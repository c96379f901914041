#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "firmware/telemetry/messages.h"
#include "firmware/telemetry/reader.h"
#include "host_tools/recording/mcap/writer.h"
#include "host_tools/recording/record/tick_ledger.h"

namespace stilt::record {

/// What a recorder does with samples of the robot: an MCAP file of their CDR bytes as they came, with the
/// messages' ROS 2 definitions, configuration and robot model attached. Topics lose ROS's "rt" on the wire:
/// /joint_states.
///
/// Commands are not kept, their token is a secret; replies, events and ticks show what was commanded. Of the
/// plans for drawing every third is kept.
class Recorder {
 public:
  struct Options {
    mcap::Compression compression = mcap::Compression::zstd;
    int level = 3;  ///< of the compression; lz4: 0 is fast
    /// Model of a robot by its name, as URDF, empty when there is none; may be left out.
    std::function<std::string(const std::string& robot)> urdf;
  };

  /// What is kept.
  [[nodiscard]] static std::vector<const telemetry::Topic*> topics();

  /// Throws std::runtime_error, one sentence, when the file cannot be written; so do the others.
  Recorder(const std::string& path, const Options& options);

  /// @param now_ns  time of day
  void take(const telemetry::Sample& sample, std::int64_t now_ns);

  /// Writes what came so far; call at least once per second.
  void flush() { writer_.flush(); }

  /// Ends the file in order.
  void close();

  [[nodiscard]] std::uint64_t messages() const { return writer_.statistics().messages; }
  [[nodiscard]] std::uint64_t bytes() const { return writer_.bytes_written(); }
  /// Ticks of each run.
  [[nodiscard]] const std::map<std::uint64_t, TickLedger>& runs() const { return runs_; }

 private:
  [[nodiscard]] std::uint16_t channel_of(const telemetry::Topic& topic);
  void keep_configuration(const telemetry::ConfigurationInForce& configuration, std::int64_t now_ns);

  Options options_;
  mcap::Writer writer_;
  std::map<const telemetry::Topic*, std::uint16_t> channels_;
  std::map<const telemetry::Topic*, std::uint32_t> counts_;
  std::map<std::uint64_t, TickLedger> runs_;
  std::uint32_t plans_ = 0;  ///< that came
};

/// "/joint_states" of rt/joint_states.
[[nodiscard]] std::string topic_in_record(const telemetry::Topic& topic);

/// The inverse; null when it is none of Stilt's.
[[nodiscard]] const telemetry::Topic* topic_of_record(const std::string& name);

/// Name of the attachment with the configuration of a run.
[[nodiscard]] std::string configuration_name(std::uint64_t run_id);

}  // namespace stilt::record
