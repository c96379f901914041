#include "host_tools/recording/replay/record_source.h"

#include <algorithm>

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

RecordSource::RecordSource(const std::string& path, std::function<Clock::time_point()> now)
    : path_(path), now_(std::move(now)) {
  record::require_wire_version(path);
  reader_ = std::make_unique<mcap::Reader>(path);
}

/// Reads the next message and its due time. Ticks have a time; other messages are due with the ticks before
/// them.
void RecordSource::advance() {
  next_.reset();
  while (!next_) {
    const mcap::ReadMessage* read = reader_->next();
    if (read == nullptr) {
      ended_ = true;
      return;
    }
    const telemetry::Topic* topic = record::topic_of_record(read->channel->topic);
    if (topic != nullptr) next_ = sample_of(*read, *topic);
  }
  if (next_->topic != &telemetry::kTicks) return;
  const auto ticks = next_->as<telemetry::TickBatch>();
  if (!ticks || ticks->count == 0 || !telemetry::well_formed(*ticks)) return;
  const std::int64_t time_ns = telemetry::span_of(ticks->time_ns).back();
  if (tick_ns_) {
    due_s_ += std::clamp(1e-9 * static_cast<double>(time_ns - *tick_ns_), 0.0, kLongestPause_s);
  }
  tick_ns_ = time_ns;
}

void RecordSource::poll(monitor::SampleSink& sink) {
  if (asked_) {
    sink.reply({asked_->commander, asked_->sequence, false, "this is a record, which takes no commands"});
    asked_.reset();
  }
  if (!start_) {
    start_ = now_();
    advance();
  }
  const double elapsed_s = std::chrono::duration<double>(now_() - *start_).count();
  while (!ended_ && due_s_ <= elapsed_s) {
    decoder_.take(*next_, sink);
    advance();
  }
}

void RecordSource::play_again() {
  reader_ = std::make_unique<mcap::Reader>(path_);
  decoder_ = monitor::MessageDecoder(monitor::Follow::newest);
  start_.reset();
  next_.reset();
  tick_ns_.reset();
  due_s_ = 0.0;
  ended_ = false;
}

void RecordSource::command(const monitor::Command& command) {
  if (command.kind != monitor::CommandKind::heartbeat) asked_ = command;
}

}  // namespace stilt::replay
