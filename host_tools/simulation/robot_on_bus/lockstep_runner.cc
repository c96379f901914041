#include <chrono>
#include <string>
#include <vector>

#include "host_tools/simulation/robot_on_bus/lockstep_exchange.h"
#include "host_tools/simulation/robot_on_bus/run_end.h"
#include "host_tools/simulation/robot_on_bus/runner.h"

namespace stilt::robot_on_bus {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t kLongestWait_ns = 50'000'000;  // interval of the checks of the stop flag
constexpr double kAlone_s = 1.0;
constexpr double kSilent_s = 1.0;  // without a turn on an interface of the kernel: the controller has left

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// One run, with its state between two polls of the buses.
class LockstepRun {
 public:
  LockstepRun(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log, const RunOptions& options)
      : robot_(robot),
        buses_(buses),
        options_(options),
        end_(options),
        ends_(robot, frame_buses(buses), log),
        exchange_(robot, ends_, options.tick_s,
                  [this](std::size_t bus) { return buses_[bus].connections(); }) {}

  RunOutcome run() {
    while (outcome_.ended[0] == '\0') turn();
    outcome_.controllers = buses_.front().connections();
    return outcome_;
  }

 private:
  void turn() {
    wait_for_frames(robot_, buses_, kLongestWait_ns);
    const bool advanced = exchange_.poll();
    if (advanced) {
      if (outcome_.controllers_came_s.size() < buses_.front().connections()) {
        outcome_.controllers_came_s.push_back(robot_.time_s());
      }
      quiet_since_ = SteadyClock::now();
      patience_s_ = options_.wait_s;
      progress_.update(robot_, options_);
    } else if (exchange_.tick() && controller_left()) {
      lose_controller();
    } else if (seconds_since(quiet_since_) > patience_s_) {
      give_up();
    }
    if (const char* reason = end_.reason(robot_, has_controller())) outcome_.ended = reason;
  }

  [[nodiscard]] bool is_controllers(std::size_t bus) const {
    return buses_[bus].connections() == exchange_.controller()[bus];
  }

  /// Whether one of its buses is disconnected, or the next controller is connected already.
  [[nodiscard]] bool controller_left() const {
    bool all_its = true;
    for (std::size_t bus = 0; bus < buses_.size(); ++bus) all_its = all_its && is_controllers(bus);
    return !all_connected(buses_) || !all_its;
  }

  /// An interface of the kernel shows a controller by its turns alone.
  [[nodiscard]] bool has_controller() const {
    if (buses_.front().is_loopback()) return any_connected(buses_);
    return exchange_.tick() && seconds_since(quiet_since_) < kSilent_s;
  }

  /// Keeps connections and frames of a controller that has come in the meantime.
  void lose_controller() {
    exchange_.forget_controller();
    for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
      if (is_controllers(bus)) buses_[bus].hang_up();
    }
    go_on_alone();
    if (options_.once) outcome_.ended = "controller left";
  }

  /// Until watchdogs have expired.
  void go_on_alone() {
    const auto ticks = static_cast<int>(kAlone_s / options_.tick_s);
    for (int i = 0; i < ticks && end_.reason(robot_, has_controller()) == nullptr; ++i) {
      exchange_.advance_alone();
    }
    quiet_since_ = SteadyClock::now();
    patience_s_ = options_.next_wait_s;
  }

  /// An interface of the kernel does not show that a controller has left: it is silent.
  void give_up() {
    outcome_.ended = exchange_.tick() ? "controller silent" : "no controller";
    if (exchange_.tick()) go_on_alone();
  }

  RobotOnBus& robot_;
  std::vector<RobotBus>& buses_;
  const RunOptions& options_;
  RunEnd end_;
  BusEnds ends_;
  LockstepExchange exchange_;
  ProgressTicks progress_;
  RunOutcome outcome_;
  SteadyClock::time_point quiet_since_ = SteadyClock::now();
  double patience_s_ = options_.wait_s;
};

}  // namespace

RunOutcome run_lockstep(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                        const RunOptions& options) {
  return LockstepRun(robot, buses, log, options).run();
}

}  // namespace stilt::robot_on_bus
