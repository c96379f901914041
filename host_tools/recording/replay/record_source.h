#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host_tools/recording/mcap/reader.h"
#include "host_tools/web/monitor/message_decoder.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::replay {

/// Plays a record for the monitor in real time, by the clock of the control loop. In lock-step that clock
/// is not the clock of the record. Gaps without messages are skipped.
class RecordSource final : public monitor::SampleSource {
 public:
  using Clock = std::chrono::steady_clock;

  /// Throws std::runtime_error, one sentence, when the file is not a record, or has messages of another
  /// wire version.
  /// @param now  clock of the playback
  explicit RecordSource(const std::string& path, std::function<Clock::time_point()> now = &Clock::now);

  void poll(monitor::SampleSink& sink) override;
  void command(const monitor::Command& command) override;
  void play_again() override;
  [[nodiscard]] std::string describe() const override { return path_; }
  [[nodiscard]] bool live() const override { return false; }

 private:
  void advance();

  std::string path_;
  std::function<Clock::time_point()> now_;
  std::unique_ptr<mcap::Reader> reader_;
  monitor::MessageDecoder decoder_{monitor::Follow::newest};
  std::optional<Clock::time_point> start_;  ///< of the playback
  std::optional<telemetry::Sample> next_;   ///< not yet due
  double due_s_ = 0.0;                      ///< of next_, since the start
  std::optional<std::int64_t> tick_ns_;     ///< of the tick read last
  std::optional<monitor::Command> asked_;   ///< command to reply to
  bool ended_ = false;
};

}  // namespace stilt::replay
