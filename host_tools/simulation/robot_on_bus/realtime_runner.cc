#include <sched.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hal/robot/clock.h"
#include "host_tools/simulation/robot_on_bus/run_end.h"
#include "host_tools/simulation/robot_on_bus/runner.h"

namespace stilt::robot_on_bus {
namespace {

constexpr std::int64_t kMostBehind_ns = 5'000'000;
constexpr int kPriority = 90;      // above any controller: motor drivers do not wait for a processor
constexpr double kLeft_s = 1.0;    // the robot's time after the controller has left, with --once
constexpr double kSilent_s = 1.0;  // without a frame on an interface of the kernel: the controller has left

bool take_priority() {
  const sched_param parameters{.sched_priority = kPriority};
  return sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

class RealtimeRun {
 public:
  RealtimeRun(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log, const RunOptions& options)
      : robot_(robot),
        buses_(buses),
        options_(options),
        end_(options),
        ends_(robot, frame_buses(buses), log),
        step_ns_(std::llround(robot.time_step_s() * 1e9)),
        next_ns_(clock_.now_ns() + step_ns_) {}

  RunOutcome run() {
    outcome_.has_priority = take_priority();
    while (outcome_.ended[0] == '\0') {
      listen();
      advance();
      look_for_end();
      wait_for_frames(robot_, buses_, next_ns_ - clock_.now_ns());
    }
    outcome_.controllers = buses_.front().connections();
    return outcome_;
  }

 private:
  void listen() {
    for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
      if (robot_.disconnected(bus)) {
        buses_[bus].hang_up();
        continue;
      }
      const auto frames = ends_.receive(bus);
      note_arrival(!frames.empty());
      if (!frames.empty()) last_frame_s_ = robot_.time_s();
      for (const hal::CanFrame& frame : frames) ends_.deliver(clock_.now_ns(), bus, frame);
    }
    ends_.send_outgoing(clock_.now_ns());
  }

  /// An idle controller sends no frame: a loopback bus shows it when it connects. An interface of the kernel
  /// shows it with its first frame.
  void note_arrival(bool has_sent) {
    const RobotBus& first = buses_.front();
    const bool shows = has_sent || first.is_loopback();
    if (shows && outcome_.controllers_came_s.size() < first.connections()) {
      outcome_.controllers_came_s.push_back(robot_.time_s());
    }
  }

  void advance() {
    const std::int64_t behind_ns = clock_.now_ns() - next_ns_;
    if (behind_ns > kMostBehind_ns) {
      ++outcome_.late;
      outcome_.late_max_s = std::max(outcome_.late_max_s, static_cast<double>(behind_ns) * 1e-9);
      next_ns_ += behind_ns;
    }
    while (next_ns_ <= clock_.now_ns()) {
      robot_.step(clock_.now_ns());
      next_ns_ += step_ns_;
      ends_.send_outgoing(clock_.now_ns());
      if (const auto bytes = robot_.take_serial(); !bytes.empty()) options_.serial(bytes);
    }
    progress_.update(robot_, options_);
  }

  void look_for_end() {
    if (const char* reason = end_.reason(robot_, has_controller())) outcome_.ended = reason;
    if (any_connected(buses_)) {
      last_seen_s_ = robot_.time_s();
    } else if (options_.once && came() && robot_.time_s() - last_seen_s_ >= kLeft_s) {
      outcome_.ended = "controller left";
    }
  }

  /// A controller that connects and dies between two looks was here, too. An interface of the kernel is
  /// always connected.
  [[nodiscard]] bool came() const { return buses_.front().connections() > 0; }

  /// An interface of the kernel shows a controller by its frames alone.
  [[nodiscard]] bool has_controller() const {
    if (buses_.front().is_loopback()) return any_connected(buses_);
    return last_frame_s_ && robot_.time_s() - *last_frame_s_ < kSilent_s;
  }

  RobotOnBus& robot_;
  std::vector<RobotBus>& buses_;
  const RunOptions& options_;
  RunEnd end_;
  BusEnds ends_;
  hal::MonotonicClock clock_;
  std::int64_t step_ns_;
  std::int64_t next_ns_;
  double last_seen_s_ = 0.0;
  std::optional<double> last_frame_s_;  ///< when the controller's newest frame came, on the robot's clock
  ProgressTicks progress_;
  RunOutcome outcome_;
};

}  // namespace

RunOutcome run_realtime(RobotOnBus& robot, std::vector<RobotBus>& buses, FrameLog& log,
                        const RunOptions& options) {
  return RealtimeRun(robot, buses, log, options).run();
}

}  // namespace stilt::robot_on_bus
