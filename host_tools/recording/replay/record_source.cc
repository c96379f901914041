#include "host_tools/recording/replay/record_source.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/record/record_version.h"
#include "host_tools/recording/record/recorder.h"

namespace stilt::replay {
namespace {

/// Ticks are further apart only at a gap of the record or at the start of another run.
constexpr double kLongestPause_s = 0.5;

telemetry::Sample sample_of(const mcap::ReadMessage& read, const telemetry::Topic& topic) {
  const auto bytes = std::as_bytes(read.message.data);
  return {&topic, read.message.publish_time_ns, 0, {bytes.begin(), bytes.end()}};
}

}  // namespace

RecordCursor::RecordCursor(const std::string& path) : reader_(std::make_unique<mcap::Reader>(path)) {
  advance();
}

void RecordCursor::advance() {
  message_.reset();
  while (!message_) {
    const mcap::ReadMessage* read = reader_->next();
    if (read == nullptr) return;
    const telemetry::Topic* topic = record::topic_of_record(read->channel->topic);
    if (topic != nullptr) message_ = sample_of(*read, *topic);
  }
  if (message_->topic != &telemetry::kTicks) return;
  const auto ticks = message_->as<telemetry::TickBatch>();
  if (!ticks || ticks->count == 0 || !telemetry::well_formed(*ticks)) return;
  const std::int64_t time_ns = telemetry::span_of(ticks->time_ns).back();
  if (tick_ns_) {
    due_s_ += std::clamp(1e-9 * static_cast<double>(time_ns - *tick_ns_), 0.0, kLongestPause_s);
  }
  tick_ns_ = time_ns;
}

RecordSource::RecordSource(const std::string& path, std::function<Clock::time_point()> now)
    : path_(path), now_(std::move(now)), cursor_(path) {
  record::require_wire_version(path);
  RecordCursor all(path);
  while (all.message() != nullptr) all.advance();
  if (!all.has_ticks()) {
    throw std::runtime_error(record::without_ticks(path, all.reader().problems()));
  }
  length_s_ = all.due_s();
  problems_ = all.reader().problems();
}

/// Passes on what lasts of the messages that are due before skip_to_s_: the newest run and its settings, then
/// its state and events.
void RecordSource::skip(monitor::SampleSink& sink) {
  std::array<Lasting, 5> lasting = {{{&telemetry::kConfiguration, 256},
                                     {&telemetry::kTuning, 256},
                                     {&telemetry::kSupervisor, 1},
                                     {&telemetry::kTiming, 1},
                                     {&telemetry::kEvents, 200}}};
  for (; cursor_.message() != nullptr && cursor_.due_s() < skip_to_s_; cursor_.advance()) {
    for (Lasting& kind : lasting) {
      if (kind.topic != cursor_.message()->topic) continue;
      kind.messages.push_back(*cursor_.message());
      if (kind.messages.size() > kind.most) kind.messages.pop_front();
    }
  }
  for (const Lasting& kind : lasting) {
    for (const telemetry::Sample& message : kind.messages) decoder_.take(message, sink);
  }
}

void RecordSource::poll(monitor::SampleSink& sink) {
  if (asked_) {
    sink.reply({asked_->commander, asked_->sequence, false, "this is a record, which takes no commands"});
    asked_.reset();
  }
  const Clock::time_point now = now_();
  if (polled_ && !held_) at_s_ += std::chrono::duration<double>(now - *polled_).count();
  at_s_ = std::min(at_s_, length_s_);
  polled_ = now;
  if (cursor_.due_s() < skip_to_s_) skip(sink);
  for (; cursor_.message() != nullptr && cursor_.due_s() <= at_s_; cursor_.advance()) {
    decoder_.take(*cursor_.message(), sink);
  }
}

void RecordSource::play_from(double from_s) {
  cursor_ = RecordCursor(path_);
  decoder_ = monitor::MessageDecoder(monitor::Follow::newest);
  at_s_ = std::clamp(from_s, 0.0, length_s_);
  skip_to_s_ = at_s_ - kBefore_s;
  polled_.reset();
}

void RecordSource::command(const monitor::Command& command) {
  if (command.kind != monitor::CommandKind::heartbeat) asked_ = command;
}

}  // namespace stilt::replay
