#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/telemetry/command_kind.h"
#include "host_tools/web/monitor/samples.h"

namespace stilt::monitor {

using telemetry::CommandKind;

/// A command of an operator to the robot.
struct Command {
  CommandKind kind = CommandKind::heartbeat;
  std::uint64_t commander = 0;  ///< one number per operator (open page)
  std::uint32_t sequence = 0;   ///< counts the operator's commands
  std::string token;            ///< token of the run; empty: the one that the source has
  /// Of stop: tokens of other runs, by run_id, for those runs.
  std::map<std::string, std::string> tokens_of_others;
  /// Of stop and cut: whether they are also sent with each token that the source has. A wrong one above then
  /// stops nothing less.
  bool with_known_tokens = false;
  double value = 0.0;   ///< m/s of walk and speed, m of height, or of the tunable
  std::string tunable;  ///< name of the tunable
};

/// A controller that sends.
struct SendingRun {
  std::string run_id;  ///< as in ConfigurationSample
  std::string robot;
};

/// Where the playing of a record is. Times in s since the first tick of the record; its gaps are shortened.
struct Playback {
  double at_s = 0.0;
  double length_s = 0.0;
  bool held = false;  ///< it stands still
};

/// Receiver of a source's samples. One call per sample, in order of time within a kind.
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  virtual void configuration(const ConfigurationSample& sample) = 0;
  virtual void tick(const TickSample& sample) = 0;
  virtual void plan(const PlanSample& sample) = 0;
  virtual void planner(const PlannerSample& sample) = 0;
  virtual void supervisor(const SupervisorSample& sample) = 0;
  virtual void event(const EventSample& sample) = 0;
  virtual void timing(const TimingSample& sample) = 0;
  virtual void truth(const TruthSample& sample) = 0;
  virtual void reply(const ReplySample& sample) = 0;
};

/// Source of samples: the network, a record or a test. All calls come from one thread.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  /// Passes on all samples since the last call, and returns; called some hundred times per second. A
  /// record plays by the clock of the calls. A new run begins with its configuration.
  virtual void poll(SampleSink& sink) = 0;

  /// Sends a command; its reply comes with a later poll(). A record refuses it in the reply. Stop goes to
  /// every run whose token its sender or, for a sender that may use them, the source has. Which of them moves
  /// may not be known. The reply is that of the run that is shown.
  virtual void command(const Command& command) = 0;

  /// The sender of commands is gone: no reply to it is needed any more.
  virtual void forget(std::uint64_t /*commander*/) {}

  /// Controllers that send now, the one that is shown among them.
  [[nodiscard]] virtual std::vector<SendingRun> talking() const { return {}; }

  /// Shows another of them from now on; no effect when it is none of them.
  virtual void choose(const std::string& /*run_id*/) {}

  /// Plays a record from another time of Playback, after what is still true then and the ticks of the seconds
  /// before it. No effect on a live source.
  virtual void play_from(double /*from_s*/) {}

  /// Holds a record where it is, or lets it go on; no effect on a live source.
  virtual void hold(bool /*held*/) {}

  /// None for a live source.
  [[nodiscard]] virtual std::optional<Playback> playback() const { return std::nullopt; }

  /// One line of text: "domain 0 on lo", "walk.mcap".
  [[nodiscard]] virtual std::string describe() const = 0;

  /// Samples ignored so far because they are of another controller that is also publishing.
  [[nodiscard]] virtual std::uint64_t of_others() const { return 0; }

  /// Why the messages of a controller cannot be shown, one sentence without its end; empty: there is none
  /// such.
  [[nodiscard]] virtual std::string refused() const { return {}; }

  /// Whether an empty token is accepted, because the source has the run's.
  [[nodiscard]] virtual bool has_token() const { return false; }

  /// False for a record: it accepts no commands, and silence at its end is not a fault.
  [[nodiscard]] virtual bool live() const = 0;
};

}  // namespace stilt::monitor
