#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "firmware/telemetry/command_kind.h"
#include "firmware/telemetry/writer.h"

namespace stilt::host_telemetry {

/// Sends commands to the robot, each with a proof of the token and not with the token. Every program that
/// shares the domain may read commands. Replies arrive as CommandReply on telemetry::kCommandReplies, with
/// this commander's name and the command's number. While in command, call heartbeat() at least every 100 ms:
/// otherwise the robot slows down.
class Commander {
 public:
  /// @param name  unique name of this commander: another commander with this name would get the replies too.
  ///              Throws std::runtime_error with one sentence when it cannot start.
  Commander(const telemetry::Participant& participant, std::string name);

  /// Sets the run of the robot, from ActiveConfiguration, and its token, from the token file or the user.
  void set_run(std::uint64_t run_id, std::string token);

  /// Sends a command. Returns its number, which the reply contains.
  std::uint64_t send(telemetry::CommandKind kind, double value = 0, const std::string& key = {});

  /// Sends a heartbeat, at most fifty per second for any rate of calls. More would push commands out of the
  /// queue that the robot reads.
  void heartbeat();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::uint64_t run_id() const noexcept { return run_id_; }

  /// Whether a robot subscribes to the commands.
  [[nodiscard]] bool has_subscriber() const { return writer_.subscribers() > 0; }

 private:
  std::string name_;
  telemetry::Writer<telemetry::Command> writer_;
  std::uint64_t run_id_ = 0;
  std::string token_;
  std::uint64_t number_ = 0;
  std::chrono::steady_clock::time_point heartbeat_{};  ///< the last one
};

/// A random name for a commander: "monitor-3fa9c1".
[[nodiscard]] std::string unique_name(const std::string& prefix);

}  // namespace stilt::host_telemetry
