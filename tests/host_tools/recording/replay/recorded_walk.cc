#include "tests/host_tools/recording/replay/recorded_walk.h"

#include <memory>
#include <random>

#include "firmware/configuration/live.h"
#include "mpc_core/gait/reference.h"
#include "tests/robots.h"

namespace stilt::replay {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr int kPlanPeriod = 10;  ///< ticks
constexpr int kPlanDelay = 4;
constexpr double kNoise_rad = 1e-5;

class Run {
 public:
  Run() : mail_(std::make_unique<control_loop::Mailboxes>()) {
    walk_.configuration = configuration::load_robot("amber3m").value();
    const model::RobotModel& robot = testing_support::amber3m();
    static_cast<void>(planner_.configure(robot, walk_.configuration));
    loop_.configure(robot, walk_.configuration, walk_.configuration.supervisor);
    loop_.attach(robot_, *mail_);
    state_ = gait::standing_state(robot.constants, walk_.configuration.reference.base_height_m, 0.0,
                                  walk_.configuration.gait.stand_half_width_m, true);
  }

  void ask(supervisor::RequestKind kind, double speed_m_s = 0.0) {
    command_.request.kind = kind;
    command_.request.speed_m_s = speed_m_s;
    ++command_.request.number;
  }

  /// Changes live tunables of torque law and planner.
  void tune(std::uint32_t number, double joint_kd_Nms_rad, double swing_height_m) {
    std::vector<double>& values = walk_.live_values[number];
    for (const configuration::LiveTunable& tunable : configuration::live_tunables(walk_.configuration)) {
      const std::string name = tunable.entry->name();
      values.push_back(name == "torque_law.joint_kd_Nms_rad" ? joint_kd_Nms_rad
                       : name == "gait.swing_height_m"       ? swing_height_m
                                                             : tunable.start_value);
    }
    Tunings& tunings = walk_.tunings[number];
    const auto work = std::make_unique<sqp::TerminalCostWorkspace>();
    static_cast<void>(control::prepare_settings(testing_support::amber3m(),
                                                configuration::with_live_values(walk_.configuration, values),
                                                *work, tunings.planner.settings));
    tunings.planner.number = number;
    tunings.torque = {number, tunings.planner.settings.parameters.torque_law};
    mail_->torque_tunings.writer() = tunings.torque;
    mail_->torque_tunings.publish();
    mail_->planner_tunings.writer() = tunings.planner;
    mail_->planner_tunings.publish();
  }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) run_tick();
  }

  RecordedWalk take() { return std::move(walk_); }

 private:
  void run_tick() {
    mail_->commands.writer() = command_;
    mail_->commands.publish();
    if (tick_ == due_) hand_over();
    const std::int64_t now_ns = 1'000'000'000 + tick_ * kTick_ns;
    const control_loop::TickRecord sensed = sense(now_ns);
    robot_.set(sensed);
    loop_.tick({.now_ns = now_ns, .wakeup_latency_ns = tick_ % 7});
    walk_.ticks.push_back(*mail_->telemetry.front());
    mail_->telemetry.pop();
    plan();
    while (mail_->events.front() != nullptr) mail_->events.pop();
    ++tick_;
  }

  void hand_over() {
    if (fresh_) {
      followed_ = mail_->plans.writer();
      mail_->plans.publish();
    }
    mail_->results.writer() = planner_.result();
    mail_->results.publish();
  }

  void plan() {
    const control_loop::PlanningRequest& request = mail_->requests.newest();
    if (request.stance_episode == 0 || tick_ % kPlanPeriod != 0) return;
    fresh_ = planner_.plan(request, *mail_);
    planner_.record(request, fresh_, 0, *mail_);
    walk_.cycles.push_back(*mail_->cycles.front());
    mail_->cycles.pop();
    due_ = tick_ + kPlanDelay;
  }

  /// The planned state of this moment, as sensors would measure it.
  control_loop::TickRecord sense(std::int64_t now_ns) {
    const double time_s = 1e-3 * static_cast<double>(tick_);
    if (followed_.nodes >= 2 && time_s >= followed_.start_time_s) {
      state_ = control::interpolate(followed_, time_s).state;
    }
    control_loop::TickRecord sensed;
    sensed.emergency_stop = hal::EmergencyStopState::released;
    sensed.bring_up = {.ready = true, .stage = hal::bring_up::Stage::ready};
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      const int joint = model::kFirstJoint + static_cast<int>(i);
      hal::JointReading& reading = sensed.joints[i];
      reading.position_rad = state_[joint] + noise();
      reading.velocity_rad_s = state_[model::kPositions + joint] + noise();
      reading.torque_Nm = noise() + commanded_torque_Nm(i);
      reading.time_ns = now_ns;
      reading.state = hal::DriverState::enabled;
    }
    sensed.base.pitch_rad = state_[model::kFirstAngle] + noise();
    sensed.base.pitch_rate_rad_s = state_[model::kPositions + model::kFirstAngle] + noise();
    sensed.base.time_ns = now_ns;
    return sensed;
  }

  /// The drivers give what they were asked for in the tick before.
  double commanded_torque_Nm(std::size_t joint) const {
    const bool commands = !walk_.ticks.empty() && walk_.ticks.back().action == supervisor::Action::commands;
    return commands ? walk_.ticks.back().sent[joint].torque_Nm : 0.0;
  }

  double noise() { return kNoise_rad * std::normal_distribution<>()(random_); }

  RecordedWalk walk_;
  std::unique_ptr<control_loop::Mailboxes> mail_;
  control_loop::PlannerTask planner_;
  control_loop::ControlLoop loop_;
  RecordedRobot robot_;
  control_loop::OperatorCommand command_;
  control::Plan followed_;
  model::StateVector state_;
  std::mt19937 random_{kWalkSeed};
  std::int64_t tick_ = 0;
  std::int64_t due_ = -1;
  bool fresh_ = false;
};

RecordedWalk walk() {
  const auto run = std::make_unique<Run>();
  run->run(3);
  run->ask(supervisor::RequestKind::calibrate);
  run->run(5);
  run->ask(supervisor::RequestKind::stand);
  run->run(1500);
  run->ask(supervisor::RequestKind::step);
  run->run(700);
  run->ask(supervisor::RequestKind::walk, 0.4);
  run->run(700);
  run->tune(1, 7.0, 0.08);
  run->run(400);
  run->tune(2, 4.0, 0.06);
  run->run(400);
  return run->take();
}

}  // namespace

const RecordedWalk& recorded_walk() {
  static const RecordedWalk made = walk();
  return made;
}

}  // namespace stilt::replay
