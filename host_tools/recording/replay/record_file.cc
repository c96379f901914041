#include "host_tools/recording/replay/record_file.h"

#include <algorithm>
#include <utility>

#include "firmware/configuration/migrate.h"
#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/cycle_message.h"
#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/mcap/reader.h"
#include "host_tools/recording/record/record_version.h"
#include "host_tools/recording/record/recorder.h"

namespace stilt::replay {
namespace {

using telemetry::ActiveConfiguration;
using telemetry::PlannerCycle;
using telemetry::TickBatch;
using telemetry::Tuning;

/// The message when it has this topic, otherwise null.
template <class T>
telemetry::Owned<T> message_of(const mcap::ReadMessage& read, const telemetry::Topic& topic) {
  if (record::topic_of_record(read.channel->topic) != &topic)
    return {nullptr, telemetry::internal::Free{nullptr}};
  return telemetry::decode<T>(std::as_bytes(read.message.data));
}

RecordedRun& run_of(RecordContents& contents, std::uint64_t number) {
  const auto known = std::ranges::find(contents.runs, number, &RecordedRun::number);
  if (known != contents.runs.end()) return *known;
  contents.runs.emplace_back().number = number;
  return contents.runs.back();
}

void take_configuration(const ActiveConfiguration& message, RecordedRun& run) {
  run.configured = true;
  run.robot = message.robot;
  run.urdf = message.urdf;
  run.configuration = message.configuration;
  run.build = std::string(message.version) + ", " + message.compiler + ", " + message.instruction_set;
  run.tunables.clear();
  run.start_clock_ns = message.start_clock_ns;
  for (const auto& tunable : telemetry::span_of(message.tunables)) run.tunables.emplace_back(tunable.key);
}

/// A subscriber that joins late can receive a solve twice; numbers rise.
void take_cycle(const PlannerCycle& message, RecordedRun& run) {
  if (!run.cycles.empty() && message.cycle <= run.cycles.back().cycle) return;
  run.cycles.push_back(telemetry::cycle_record(message));
}

void take(const mcap::ReadMessage& read, RecordContents& contents) {
  if (const auto cycle = message_of<PlannerCycle>(read, telemetry::kPlannerCycles)) {
    take_cycle(*cycle, run_of(contents, cycle->run_id));
  } else if (const auto ticks = message_of<TickBatch>(read, telemetry::kTicks)) {
    run_of(contents, ticks->run_id).ticks.add(ticks->first_tick, ticks->count);
  } else if (const auto configuration = message_of<ActiveConfiguration>(read, telemetry::kConfiguration)) {
    take_configuration(*configuration, run_of(contents, configuration->run_id));
  } else if (const auto tuning = message_of<Tuning>(read, telemetry::kTuning)) {
    const auto values = telemetry::span_of(tuning->values);
    run_of(contents, tuning->run_id).tunings[tuning->number] = {values.begin(), values.end()};
  }
}

/// Names of attachment and metadata are those of record::Recorder.
void take_attached(const std::string& path, const mcap::Reader& reader, RecordedRun& run) {
  const std::vector<mcap::Attachment>& files = reader.attachments();
  const std::string name = record::configuration_name(run.number);
  const auto toml = std::ranges::find(files, name, &mcap::Attachment::name);
  const auto of_run = std::ranges::find_if(reader.metadata(), [&](const mcap::Metadata& one) {
    const auto number = one.entries.find("run_id");
    return number != one.entries.end() && number->second == std::to_string(run.number);
  });
  if (toml == files.end() || of_run == reader.metadata().end()) return;
  record::require_wire_version(path, *of_run);
  const auto entry = [&](const char* key) {
    const auto found = of_run->entries.find(key);
    return found == of_run->entries.end() ? std::string() : found->second;
  };
  run.configured = run.attached = true;
  run.robot = entry("robot");
  run.configuration = toml->data;
  run.build = entry("version") + ", " + entry("compiler") + ", " + entry("instruction_set");
  // Behind it: an earlier run may have had another robot of this name.
  const auto urdf = std::ranges::find(toml, files.end(), run.robot + ".urdf", &mcap::Attachment::name);
  if (urdf != files.end()) run.urdf = urdf->data;
}

}  // namespace

RecordContents read_contents(const std::string& path) {
  RecordContents contents;
  mcap::Reader reader(path);
  while (const mcap::ReadMessage* read = reader.next()) {
    record::require_wire_version(path, *read);
    take(*read, contents);
  }
  contents.problems = reader.problems();
  for (RecordedRun& run : contents.runs) {
    if (!run.configured) take_attached(path, reader, run);
    if (!run.configured) run.why_not_configured = record::without_configuration(path, contents.problems);
  }
  return contents;
}

std::expected<configuration::Configuration, std::string> configuration_of(const RecordedRun& run) {
  const auto refused = [](const configuration::Diagnostic& mistake) {
    return std::unexpected("the recorded configuration is refused by this program: " + to_string(mistake));
  };
  const auto migration = configuration::migrate(run.configuration, kRecordedConfiguration);
  if (!migration) return refused(migration.error());
  auto configuration = configuration::parse(migration->text, kRecordedConfiguration);
  if (!configuration) return refused(configuration.error().front());
  return *std::move(configuration);
}

void for_each_tick(const std::string& path, std::uint64_t run_id,
                   const std::function<bool(const control_loop::TickRecord&)>& use) {
  mcap::Reader reader(path);
  std::uint64_t next = 0;
  while (const mcap::ReadMessage* read = reader.next()) {
    const auto ticks = message_of<TickBatch>(*read, telemetry::kTicks);
    if (!ticks || ticks->run_id != run_id || !telemetry::well_formed(*ticks)) continue;
    for (std::size_t i = 0; i < ticks->count; ++i) {
      if (ticks->first_tick + i < next) continue;
      next = ticks->first_tick + i + 1;
      if (!use(telemetry::tick_record(*ticks, i))) return;
    }
  }
}

}  // namespace stilt::replay
