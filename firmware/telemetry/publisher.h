#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/events.h"
#include "firmware/control_loop/tick_record.h"
#include "firmware/diagnostics/event_text.h"
#include "firmware/diagnostics/statistics.h"
#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/tuner.h"
#include "firmware/telemetry/wall_time.h"
#include "firmware/telemetry/writer.h"

namespace stilt::telemetry {

/// What a run of stiltd is, beside its configuration.
struct RunDescription {
  std::string version;
  std::string compiler;
  std::string instruction_set;
  bool lockstep = false;
  std::string not_realtime;  ///< why; empty: real time
  std::string token_file;
  std::string configuration_source;  ///< the configuration file and the preset, for people
};

/// Losses on the way from the real-time threads.
struct Drops {
  std::uint64_t ticks = 0;
  std::uint64_t cycles = 0;
  std::uint64_t events = 0;
};

/// Who is in command, for Supervisor.
struct InCommand {
  std::string name;  ///< empty: none
  bool alive = false;
};

/// Fills and sends the messages of stilt_msgs.idl. Ordinary threads; everything that is given outlives the
/// call only.
class Publisher {
 public:
  [[nodiscard]] static std::expected<Publisher, std::string> open(const Participant& participant,
                                                                  std::uint64_t run_id);

  void configuration(const configuration::Configuration& configuration, const RunDescription& run,
                     const Tuner& tuner, const WallTime& time);
  void tuning(const Tuner& tuner, const std::string& key, const std::string& commander);
  void cycle(const control_loop::CycleRecord& record, const Drops& drops);
  void plan(const control_loop::PlanPreview& preview, const control::PlannerSettings& settings);
  void supervisor(const control_loop::TickRecord& tick, const WallTime& time, const InCommand& in_command,
                  double base_height_m, const diagnostics::FoundWords& found);
  void event(const control_loop::Event& event, const Drops& drops);
  /// Event of kind 4 (a command) or 5 (the commander).
  void note(std::uint8_t kind, double time_s, const std::string& name, const std::string& text,
            const Drops& drops);
  void timing(const diagnostics::LoopStatistics& loop, const diagnostics::PlannerStatistics& planning,
              const configuration::Configuration& configuration, double time_s, const Drops& drops);
  /// Proves the token of the run with the reply.
  void reply(std::string_view token, const std::string& commander, std::uint64_t number, bool accepted,
             const std::string& reason, double time_s);
  void ticks(TickBatchBuilder& batch, const Drops& drops);

  /// Waits until subscribers have what was sent, at most so long. False: one has not.
  bool flush(double longest_s);

 private:
  void send(Event& event, const Drops& drops);

  std::uint64_t run_id_ = 0;
  std::uint64_t events_ = 0;
  Writer<TickBatch> ticks_;
  Writer<PlannerCycle> cycles_;
  Writer<Plan> plans_;
  Writer<Supervisor> supervisor_;
  Writer<Event> events_writer_;
  Writer<Timing> timing_;
  Writer<ActiveConfiguration> configuration_;
  Writer<Tuning> tuning_;
  Writer<CommandReply> replies_;
};

}  // namespace stilt::telemetry
