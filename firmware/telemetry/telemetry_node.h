#pragma once

#include <chrono>
#include <expected>
#include <memory>
#include <string>

#include "firmware/telemetry/command_arbiter.h"
#include "firmware/telemetry/publisher.h"
#include "firmware/telemetry/reader.h"
#include "firmware/telemetry/ros_publisher.h"
#include "firmware/telemetry/token.h"

namespace stilt::telemetry {

/// Everything of telemetry on the robot: publishes what the real-time threads left in their rings, takes
/// commands. Works on the thread that calls it, which is an ordinary one; Cyclone's threads do the rest. What
/// the torque loop computes does not depend on it, commands apart.
class TelemetryNode {
 public:
  /// Joins the network; no other process may have the run's token file, unless telemetry.fixed_token. Before
  /// memory is locked. The error is one sentence for the user.
  /// @param configuration, mail  outlive the node
  [[nodiscard]] static std::expected<std::unique_ptr<TelemetryNode>, std::string> open(
      const configuration::Configuration& configuration, const RunDescription& run,
      control_loop::Mailboxes& mail);

  /// Writes the token, from which on commands are taken. Before anything below. The error is one sentence for
  /// the user.
  [[nodiscard]] std::expected<void, std::string> take_commands();

  /// Why this is not real time, known after the node was opened.
  void set_not_realtime(const std::string& reason) { run_.not_realtime = reason; }

  /// A tick that was; every one, in order.
  void tick(const control_loop::TickRecord& record);

  /// Something that happened.
  void event(const control_loop::Event& event);

  /// Sends what is due: solves and previews out of the mailboxes, statistics.
  void publish(const diagnostics::LoopStatistics& loop, const diagnostics::PlannerStatistics& planning);

  /// Takes commands.
  /// @param script  what would be commanded without anybody
  /// @return        what is
  [[nodiscard]] control_loop::OperatorCommand operate(const control_loop::OperatorCommand& script);

  /// Sends what is left, and waits a moment until subscribers have it.
  void flush();

  [[nodiscard]] std::uint64_t run_id() const noexcept { return run_id_; }
  [[nodiscard]] const std::string& token_file() const noexcept { return run_.token_file; }

 private:
  TelemetryNode(const configuration::Configuration& configuration, RunDescription run,
                control_loop::Mailboxes& mail, const model::RobotModel& robot);
  [[nodiscard]] std::expected<void, std::string> join();
  void begin(const control_loop::TickRecord& record);
  void answer(const Command& command);
  [[nodiscard]] RobotNow now() const;
  [[nodiscard]] double damping_left_s() const;
  [[nodiscard]] Drops drops() const;
  void send_supervisor();
  void send_batch();
  void watch_commander();

  const configuration::Configuration& configuration_;
  RunDescription run_;
  control_loop::Mailboxes& mail_;
  std::uint64_t run_id_;
  Tuner tuner_;
  std::string tuned_by_;
  TokenFile token_file_;  ///< empty with telemetry.fixed_token
  std::string token_;     ///< of this run; empty until commands are taken
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<RosPublisher> ros_;
  std::unique_ptr<Reader> commands_;
  std::unique_ptr<Reader> twists_;
  std::unique_ptr<CommandArbiter> arbiter_;

  TickBatchBuilder batch_;
  std::uint64_t batches_ = 0;  ///< sent
  WallTime time_;
  bool begun_ = false;
  control_loop::TickRecord newest_;
  std::int64_t damped_ns_ = 0;  ///< the joints last began to be damped, in ready or fault
  diagnostics::FoundWords found_;
  std::uint64_t joint_states_every_;   ///< ticks
  std::uint64_t supervisor_every_;     ///< ticks
  std::uint64_t second_;               ///< ticks
  std::uint64_t statistics_due_ = 0;   ///< tick
  bool changed_ = false;               ///< since the last diagnostics
  std::string commander_;              ///< when last looked
  std::int64_t operated_wall_ns_ = 0;  ///< end of the last operate(); 0: none yet
  double standstill_s_ = 0;            ///< before the present operate()
};

}  // namespace stilt::telemetry
