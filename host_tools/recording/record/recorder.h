#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include "firmware/telemetry/messages.h"
#include "firmware/telemetry/reader.h"
#include "host_tools/recording/mcap/writer.h"
#include "host_tools/recording/record/tick_ledger.h"

namespace stilt::record {

/// Writes samples of the robot to an MCAP file: their CDR bytes unchanged, with the messages' ROS 2
/// definitions; configuration and robot model are attached. Topics lose ROS's prefix "rt": /joint_states.
///
/// Commands are not recorded because their token is a secret; replies, events and ticks show what was
/// commanded. Every third plan for drawing is recorded.
class Recorder {
 public:
  struct Options {
    mcap::Compression compression = mcap::Compression::zstd;
    int level = 3;  ///< of the compression; lz4: 0 is the fastest
  };

  /// The topics that are recorded.
  [[nodiscard]] static std::vector<const telemetry::Topic*> topics();

  /// Throws std::runtime_error, one sentence, when the file cannot be written, as do the other functions.
  Recorder(const std::string& path, const Options& options);

  /// @param now_ns  time of day, ns
  void take(const telemetry::Sample& sample, std::int64_t now_ns);

  /// Writes the samples so far. Call at least once per second.
  void flush();

  /// Closes the file properly.
  void close();

  [[nodiscard]] std::uint64_t messages() const { return writer_.statistics().messages; }
  [[nodiscard]] std::uint64_t bytes() const { return writer_.bytes_written(); }
  /// Why this program cannot use what was recorded: a run with another wire version. Empty: it can.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Ticks of each run that are in the file.
  [[nodiscard]] const std::map<std::uint64_t, TickLedger>& runs() const { return runs_; }

 private:
  [[nodiscard]] std::uint16_t channel_of(const telemetry::Topic& topic);
  void keep_configuration(const telemetry::ActiveConfiguration& configuration, std::int64_t now_ns);
  void count_written();

  Options options_;
  mcap::Writer writer_;
  std::map<const telemetry::Topic*, std::uint16_t> channels_;
  std::map<const telemetry::Topic*, std::uint32_t> counts_;
  std::map<std::uint64_t, TickLedger> runs_;
  struct Ticks {
    std::uint64_t run_id, first, count;
  };
  std::vector<Ticks> open_;  ///< ticks of the open chunk
  std::uint32_t plans_ = 0;  ///< number received
  std::string problem_;
};

/// Name of a topic in a record: "/joint_states" for rt/joint_states.
[[nodiscard]] std::string topic_in_record(const telemetry::Topic& topic);

/// The inverse of topic_in_record(); null for other names.
[[nodiscard]] const telemetry::Topic* topic_of_record(const std::string& name);

/// Name of the attachment with the configuration of a run; that of a robot's URDF is ROBOT.urdf.
[[nodiscard]] std::string configuration_name(std::uint64_t run_id);

}  // namespace stilt::record
