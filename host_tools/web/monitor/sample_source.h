#pragma once

#include <cstdint>
#include <string>

#include "host_tools/web/monitor/samples.h"

namespace stilt::monitor {

enum class CommandKind { stand, step, walk, speed, height, sit, stop, reset, tunable, heartbeat };

/// What an operator asks of the robot.
struct Command {
  CommandKind kind = CommandKind::heartbeat;
  std::uint64_t commander = 0;  ///< one number for each operator (each open page)
  std::uint32_t sequence = 0;   ///< counts his commands
  std::string token;            ///< of the run; empty: the one that the source knows
  double value = 0.0;           ///< m/s of walk and speed, m of height, or of the tunable
  std::string tunable;          ///< its name
};

/// Takes what a source has to say. One call a sample, in order of time within a kind.
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

/// Where samples come from: the network, a record, a test. All calls come from one thread.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  /// Hands over everything that is new since the last call, and returns; called some hundred times per
  /// second. A record plays by the clock of its own calls. A new run begins with its configuration.
  virtual void poll(SampleSink& sink) = 0;

  /// Sends a command; its reply comes with a later poll(). A record answers that it takes none.
  virtual void command(const Command& command) = 0;

  /// A record plays from its start again; nothing happens to a live source.
  virtual void play_again() {}

  /// One line for people: "domain 0 on lo", "walk.mcap".
  [[nodiscard]] virtual std::string describe() const = 0;

  /// Samples left out so far because they are of another controller, which talks at the same time.
  [[nodiscard]] virtual std::uint64_t of_others() const { return 0; }

  /// Whether an empty token will do, because the source knows the run's.
  [[nodiscard]] virtual bool has_token() const { return false; }

  /// False for a record: nothing can be commanded, and silence at its end is no fault.
  [[nodiscard]] virtual bool live() const = 0;
};

}  // namespace stilt::monitor
