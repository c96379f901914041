#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/recording/mcap/reader.h"
#include "host_tools/web/monitor/message_decoder.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::replay {

/// Reads the messages of a record in turn. Each has the time at which it is due when the record is played,
/// s since the first tick. That is the clock of the control loop, which in lock-step is not that of the
/// record. Gaps without ticks are shortened. Ticks have a time; other messages are due with the ticks
/// before them.
class RecordCursor {
 public:
  /// Stands on the first message. Throws as mcap::Reader.
  explicit RecordCursor(const std::string& path);

  [[nodiscard]] const mcap::Reader& reader() const { return *reader_; }
  [[nodiscard]] bool has_ticks() const { return tick_ns_.has_value(); }  ///< so far

  /// The next message; null at the end.
  [[nodiscard]] const telemetry::Sample* message() const { return message_ ? &*message_ : nullptr; }
  [[nodiscard]] double due_s() const { return due_s_; }

  void advance();

 private:
  std::unique_ptr<mcap::Reader> reader_;
  std::optional<telemetry::Sample> message_;
  std::optional<std::int64_t> tick_ns_;  ///< of the tick read last
  double due_s_ = 0.0;
};

/// Plays a record for the monitor in real time.
class RecordSource final : public monitor::SampleSource {
 public:
  using Clock = std::chrono::steady_clock;

  /// Seconds of ticks before the time of play_from() that are passed on too.
  static constexpr double kBefore_s = 5.0;

  /// Throws std::runtime_error, one sentence, when the file is not a record, holds no ticks, or has messages
  /// of another wire version.
  /// @param now  clock of the playback
  explicit RecordSource(const std::string& path, std::function<Clock::time_point()> now = &Clock::now);

  /// Of the file, one sentence each: the readable part is played.
  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

  void poll(monitor::SampleSink& sink) override;
  void command(const monitor::Command& command) override;
  void play_from(double from_s) override;
  void hold(bool held) override { held_ = held; }
  [[nodiscard]] std::optional<monitor::Playback> playback() const override {
    return monitor::Playback{at_s_, length_s_, held_};
  }
  [[nodiscard]] std::string describe() const override { return path_; }
  [[nodiscard]] bool live() const override { return false; }
  [[nodiscard]] std::string refused() const override { return decoder_.refused(); }

 private:
  /// The last messages of a topic that are still true later.
  struct Lasting {
    const telemetry::Topic* topic;
    std::size_t most;
    std::deque<telemetry::Sample> messages{};
  };

  void skip(monitor::SampleSink& sink);

  std::string path_;
  std::function<Clock::time_point()> now_;
  double length_s_ = 0.0;
  std::vector<std::string> problems_;
  RecordCursor cursor_;
  monitor::MessageDecoder decoder_{monitor::Follow::newest};
  std::optional<Clock::time_point> polled_;  ///< time of the last poll
  double at_s_ = 0.0;
  double skip_to_s_ = 0.0;  ///< of what is due earlier, only what lasts is passed on
  bool held_ = false;
  std::optional<monitor::Command> asked_;  ///< command to reply to
};

}  // namespace stilt::replay
