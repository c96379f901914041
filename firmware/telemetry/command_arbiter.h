#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "firmware/control_loop/messages.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/parameters.h"
#include "firmware/supervisor/state.h"
#include "firmware/telemetry/command_kind.h"

namespace stilt::telemetry {

/// What the arbiter requires.
struct ArbiterRules {
  std::uint64_t run_id = 0;
  std::string token;           ///< without it nothing is accepted
  std::string token_file;      ///< named in refusals
  double speed_limit_m_s = 0;  ///< of walk, speed and cmd_vel, either way
  supervisor::SupervisorParameters supervisor;
  double release_s = 2.0;  ///< silence after which somebody is no longer the commander
  bool cmd_vel = false;    ///< whether Twist is listened to
};

/// A command as it came.
struct Asked {
  std::uint64_t run_id = 0;
  std::string token;  ///< a proof of it (secret.h), or the token itself
  std::string commander;
  std::uint64_t number = 0;
  std::uint8_t kind = 0;  ///< CommandKind
  double value = 0;
  std::string key;
};

/// What became of it. No answer is sent when it is silent: a heartbeat that is fine needs none. Those
/// without the token may repeat what others have sent. They get at most twenty per second, so that a flood
/// of theirs does not become a flood of ours.
struct Answer {
  bool accepted = false;
  bool silent = false;
  std::string reason;  ///< why not, or why it changes nothing yet, one sentence
};

/// Why an order makes no sense in a state, one sentence; empty: it does.
[[nodiscard]] std::string wrong_state(CommandKind kind, supervisor::State state);

/// The robot as the arbiter needs it: the newest tick.
struct RobotNow {
  std::int64_t clock_ns = 0;  ///< of the torque loop, virtual in lock-step
  std::int64_t wall_ns = 0;   ///< CLOCK_MONOTONIC, measures heartbeats
  supervisor::State state = supervisor::State::boot;
  supervisor::FaultSet present;  ///< faults whose cause is there
  supervisor::FaultSet latched;  ///< those that wait for a reset
  double standstill_s = 0;       ///< of housekeeping, before the commands of now
  double damping_left_s = 0;     ///< of the joints, before a reset begins or the motors go off
};

/// Who may command the robot, and what the torque loop is asked to do. One commander at a time: the one who
/// gave the last order of motion and sends heartbeats. `stop` and `cut` are taken from everybody with the
/// token. Orders that waited while housekeeping stood still for more than heartbeat_timeout_s are refused:
/// the robot may be at rest since. When its heartbeats stop for heartbeat_timeout_s, the supervisor makes
/// walking stepping and stepping standing (heartbeat_lost), and another may command. After release_s there is
/// no commander, until one gives an order or the lost one is back. A robot that was asked to sit or to switch
/// off goes on. Pure logic: no network, no clock, no thread. Ordinary threads.
class CommandArbiter {
 public:
  /// Sets a live tunable; the answer is empty or what is wrong, one sentence.
  using SetTunable = std::function<std::string(const std::string& key, double value)>;

  CommandArbiter(ArbiterRules rules, SetTunable set_tunable)
      : rules_(std::move(rules)), set_tunable_(std::move(set_tunable)) {}

  /// Decides about a command.
  [[nodiscard]] Answer take(const Asked& asked, const RobotNow& now);

  /// A Twist came. It acts only where the rules allow it, while a commander sends heartbeats and the robot
  /// walks. After heartbeat_timeout_s without another the speed is again that of the commander's last order.
  void twist(double speed_m_s, const RobotNow& now);

  /// What the torque loop shall do now. Until the first order came that is the command of `script`.
  [[nodiscard]] control_loop::OperatorCommand command(const control_loop::OperatorCommand& script,
                                                      const RobotNow& now);

  [[nodiscard]] const std::string& commander() const noexcept { return commander_; }
  [[nodiscard]] bool alive(const RobotNow& now) const noexcept;

 private:
  [[nodiscard]] bool has_token(const Asked& asked) const;
  [[nodiscard]] std::string rejection(const Asked& asked) const;
  /// Of a commander's newest command; nullptr: none is remembered.
  [[nodiscard]] const std::uint64_t* last_number(const std::string& commander) const;
  void remember(const std::string& commander, std::uint64_t number);
  [[nodiscard]] Answer reject(std::string reason, const RobotNow& now) noexcept;
  [[nodiscard]] std::string refusal(const Asked& asked, const RobotNow& now);
  [[nodiscard]] std::string refusal_of_order(const Asked& asked, CommandKind kind, const RobotNow& now) const;
  [[nodiscard]] std::string apply(const Asked& asked, CommandKind kind, const RobotNow& now);
  void ask(supervisor::RequestKind kind, double speed_m_s = 0) noexcept;
  void stop(const RobotNow& now) noexcept;
  /// A stand was asked for and has not begun.
  [[nodiscard]] bool waits_to_stand(supervisor::State state) const noexcept;
  [[nodiscard]] std::string dropped_by_stop(supervisor::State state) const;
  [[nodiscard]] std::string caveat(CommandKind kind, const RobotNow& now) const;
  [[nodiscard]] double silence_s(const RobotNow& now) const noexcept;
  [[nodiscard]] double asked_speed_m_s(const RobotNow& now) const noexcept;

  /// The newest Twist that acted since the last order.
  struct NewestTwist {
    bool came = false;
    double speed_m_s = 0;
    std::int64_t wall_ns = 0;
  };

  ArbiterRules rules_;
  SetTunable set_tunable_;
  using Latecomer = std::pair<std::string, std::uint64_t>;

  std::map<std::string, std::uint64_t> numbers_;  ///< last of every commander
  /// Of those beyond the most commanders, who may only stop and cut: the newest few.
  std::deque<Latecomer> latecomers_;
  std::string commander_;  ///< empty: none
  std::int64_t heartbeat_wall_ns_ = 0;
  supervisor::Request request_;  ///< with the speed of the order
  NewestTwist twist_;
  std::string lost_commander_;  ///< the last one, which fell silent; empty: it released, or one commands
  bool script_ended_ = false;   ///< by the first command; the script is not followed any more
  bool standing_up_ = false;    ///< after the bring-up: stand
  bool ending_ = false;         ///< stiltd
  bool rejected_ = false;
  std::int64_t rejected_wall_ns_ = 0;  ///< when somebody without the token was answered last
};

}  // namespace stilt::telemetry
