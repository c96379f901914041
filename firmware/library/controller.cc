#include <stilt/controller.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/library/given_robot.h"
#include "firmware/library/read_settings.h"
#include "firmware/program/configure_controller.h"

/// The library: docs/decisions/0034-library.md.
namespace stilt {
namespace {

std::int64_t period_ns(double rate_hz) { return std::llround(1e9 / rate_hz); }

supervisor::RequestKind kind_of(Motion motion) noexcept {
  switch (motion) {
    case Motion::enable:
      return supervisor::RequestKind::calibrate;
    case Motion::stand:
      return supervisor::RequestKind::stand;
    case Motion::step:
      return supervisor::RequestKind::step;
    case Motion::walk:
      return supervisor::RequestKind::walk;
    case Motion::sit:
      return supervisor::RequestKind::sit;
    case Motion::reset:
      return supervisor::RequestKind::reset;
    case Motion::off:
      return supervisor::RequestKind::off;
    case Motion::cut:
      break;
  }
  return supervisor::RequestKind::cut;
}

/// The first of the faults, "" without any.
const char* first_of(supervisor::FaultSet faults) noexcept {
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    if (faults.has(row.fault)) return row.name;
  }
  return "";
}

}  // namespace

struct Controller::Parts {
  explicit Parts(const configuration::Configuration& read)
      : configuration(read),
        robot(configuration::base_period_ticks(read.hardware, read.timing.torque_rate_hz)) {}

  configuration::Configuration configuration;
  gait::GaitLibrary gaits;
  control_loop::PlannerTask planner;
  control_loop::ControlLoop loop;
  control_loop::Mailboxes mail;
  library::GivenRobot robot;
  control_loop::OperatorCommand command;
  std::int64_t planned_tick = -1;
  Tick tick;
};

Controller::Controller(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
Controller::Controller(Controller&&) noexcept = default;
Controller& Controller::operator=(Controller&&) noexcept = default;
Controller::~Controller() = default;

std::expected<Controller, std::string> Controller::create(const Settings& settings) {
  auto configuration = library::read_settings(settings);
  if (!configuration) return std::unexpected(configuration.error());
  auto parts = std::make_unique<Parts>(*configuration);
  const std::string source =
      settings.configuration_file.empty() ? parts->configuration.hardware.robot : settings.configuration_file;
  const auto configured =
      program::configure_controller(parts->configuration, source, parts->planner, parts->loop, &parts->gaits);
  if (!configured) return std::unexpected(configured.error());
  parts->loop.attach(parts->robot, parts->mail);
  return Controller(std::move(parts));
}

std::int64_t Controller::tick_period_ns() const noexcept {
  return period_ns(parts_->configuration.timing.torque_rate_hz);
}

std::int64_t Controller::plan_period_ns() const noexcept {
  return period_ns(parts_->configuration.timing.plan_rate_hz);
}

void Controller::begin_standing(std::int64_t now_ns, const Measurements& measurements) noexcept {
  parts_->robot.give(measurements);
  parts_->planner.restart();
  parts_->loop.begin_standing(now_ns, {gait::GaitKind::stand, 0.0});
  static_cast<void>(plan());
  parts_->planned_tick = -1;
}

void Controller::request(Motion motion, double speed_m_s) noexcept {
  const double limit_m_s = parts_->configuration.telemetry.speed_limit_m_s;
  supervisor::Request& request = parts_->command.request;
  request = {kind_of(motion), request.number + 1, std::clamp(speed_m_s, -limit_m_s, limit_m_s)};
  parts_->mail.commands.writer() = parts_->command;
  parts_->mail.commands.publish();
}

const Tick& Controller::tick(std::int64_t now_ns, const Measurements& measurements) noexcept {
  Parts& p = *parts_;
  p.robot.give(measurements);
  p.loop.tick({.now_ns = now_ns});
  while (p.mail.events.front() != nullptr) p.mail.events.pop();
  p.tick.time_s = p.loop.time_s();
  p.tick.action = p.robot.action();
  p.tick.targets = p.robot.targets();
  while (const control_loop::TickRecord* record = p.mail.telemetry.front()) {
    std::ranges::copy(record->estimated_state, p.tick.estimated_state.begin());
    p.tick.state = supervisor::name(record->state);
    p.tick.fallback_level = supervisor::name(record->level);
    p.tick.fault = first_of(record->present | record->latched);
    p.tick.plan_age_s = record->plan_age_s;
    p.tick.follows_plan = record->plan_sequence >= 0;
    p.mail.telemetry.pop();
  }
  return p.tick;
}

bool Controller::plan() noexcept {
  Parts& p = *parts_;
  const control_loop::PlanningRequest& request = p.mail.requests.newest();
  if (request.stance_episode == 0 || request.tick == p.planned_tick) return false;
  p.planned_tick = request.tick;
  const bool fresh = p.planner.plan(request, p.mail);
  p.planner.record(request, fresh, 0, p.mail);
  if (fresh) p.mail.plans.publish();
  p.mail.results.writer() = p.planner.result();
  p.mail.results.publish();
  while (p.mail.cycles.front() != nullptr) p.mail.cycles.pop();
  return fresh;
}

}  // namespace stilt
