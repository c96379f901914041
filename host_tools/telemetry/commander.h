#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "firmware/telemetry/command_kind.h"
#include "firmware/telemetry/writer.h"

namespace stilt::host_telemetry {

/// Commands the robot. Replies come as CommandReply on telemetry::kCommandReplies, with this commander's name
/// and the command's number. Call heartbeat() at least every 100 ms while in command: the robot slows down
/// without.
class Commander {
 public:
  /// @param name  of this commander, unique: somebody else of that name would get the replies too. Throws
  ///              std::runtime_error with a sentence when it cannot start.
  Commander(const telemetry::Participant& participant, std::string name);

  /// run_id of stiltd, from ConfigurationInForce, and its token, from the token file or the user.
  void set_run(std::uint64_t run_id, std::string token);

  /// Sends. Returns the number of the command, which its reply names.
  std::uint64_t send(telemetry::CommandKind kind, double value = 0, const std::string& key = {});

  /// The commander lives. Sends at most fifty per second, however often it is called: more would push orders
  /// out of what the robot keeps until it looks.
  void heartbeat();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::uint64_t run_id() const noexcept { return run_id_; }

  /// A robot listens.
  [[nodiscard]] bool has_subscriber() const { return writer_.subscribers() > 0; }

 private:
  std::string name_;
  telemetry::Writer<telemetry::Command> writer_;
  std::uint64_t run_id_ = 0;
  std::string token_;
  std::uint64_t number_ = 0;
  std::chrono::steady_clock::time_point heartbeat_{};  ///< the last one
};

/// Random name for a commander: "monitor-3fa9c1".
[[nodiscard]] std::string unique_name(const std::string& prefix);

/// The token in a file: its first line. Throws std::runtime_error with a sentence.
[[nodiscard]] std::string read_token(const std::string& path);

}  // namespace stilt::host_telemetry
