#include "firmware/program/controller_state.h"

#include <algorithm>

#include "firmware/commissioning/formatted.h"
#include "firmware/configuration/hardware.h"
#include "firmware/configuration/robot_bring_up.h"
#include "firmware/program/configure_controller.h"
#include "firmware/robots/robots.h"
#include "firmware/telemetry/telemetry_node.h"

namespace stilt::program {
namespace {

/// Before the offsets are known, an angle may be anywhere.
bool angles_are_known(Task task) {
  return task != Task::watch && task != Task::jog && task != Task::calibrate;
}

std::expected<void, std::string> start_serial_sensor(const Options& options, const hal::RobotWiring& wiring,
                                                     ControllerState& state) {
  if (!wiring.serial_imu) return {};
  if (options.lockstep) {
    return std::unexpected(
        "--lockstep: torso_sensor.device is on a serial port, which has no virtual time; omit --lockstep, "
        "or "
        "take a sensor on a bus");
  }
  const configuration::TorsoSensorParameters& sensor = options.configuration.hardware.torso_sensor;
  // Above the planner, that no solve delays it, and below the torque loop.
  const int priority = std::max(options.configuration.runtime.torque_priority - 1, 0);
  const auto started = state.serial_torso_sensor.start({.port = sensor.serial_port,
                                                        .bit_rate_bit_s = sensor.serial_baud,
                                                        .mounting = *wiring.serial_imu,
                                                        .priority = priority});
  if (started) state.hardware->attach(state.serial_torso_sensor);
  return started;
}

}  // namespace

std::expected<void, std::string> set_up(const Options& options, std::span<hal::FrameBus* const> buses,
                                        ControllerState& state) {
  const configuration::Configuration& configuration = options.configuration;
  if (const auto ready =
          configure_controller(configuration, options.source, state.planner, state.control, &state.gaits);
      !ready) {
    return ready;
  }
  const auto robot = robots::find(configuration.hardware.robot);
  if (!robot) return std::unexpected(options.source + ": hardware.robot: " + robot.error());
  std::array<hal::FrameBus*, hal::kMaximumBuses> carried{};
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    state.lockstep_buses[bus].attach(*buses[bus]);
    carried[bus] = options.lockstep ? &state.lockstep_buses[bus] : buses[bus];
  }
  const hal::RobotWiring wiring =
      configuration::robot_wiring(configuration.hardware, configuration.timing.torque_rate_hz);
  const auto required = configuration::bring_up_options(configuration.hardware, (*robot)->model.constants,
                                                        angles_are_known(options.task));
  state.hardware.emplace(wiring, required, std::span(carried).first(buses.size()));
  if (const auto started = start_serial_sensor(options, wiring, state); !started) return started;
  state.control.attach(*state.hardware, state.mail);
  state.script.emplace(options.start, configuration.runtime.start_settle_s, options.duration_s);
  return {};
}

namespace {

/// A disk or a terminal may hold housekeeping up for so long, and longer by supervisor.heartbeat_timeout_s.
constexpr std::int64_t kMayBlock_ns = 1'000'000'000;

void take_ticks(ControllerState& state) {
  while (const control_loop::TickRecord* tick = state.mail.telemetry.front()) {
    state.newest_tick = *tick;
    if (tick->tick == 0) state.start_ns = tick->time_ns;
    if (state.telemetry_node != nullptr) state.telemetry_node->tick(*tick);
    state.mail.telemetry.pop();
  }
}

}  // namespace

void operate(ControllerState& state) {
  take_ticks(state);
  const control_loop::TickRecord& tick = state.newest_tick;
  const double time_s = 1e-9 * static_cast<double>(tick.time_ns - state.start_ns);
  control_loop::OperatorCommand& command = state.mail.commands.writer();
  command = state.mail.stops.merged_into(state.script->command(time_s, tick.state, tick.ramp));
  if (state.telemetry_node != nullptr) command = state.telemetry_node->operate(command);
  if (!command.heartbeat_expected) {
    command.heartbeat_expected = true;
    command.heartbeat_ns = tick.time_ns + kMayBlock_ns;
  }
  state.mail.commands.publish();
}

void restore_buses(ControllerState& state) {
  if (state.reconnect) state.hardware->serve_restore(state.reconnect);
}

void finish_cycle(ControllerState& state, const control_loop::PlanningRequest& request, bool fresh,
                  std::int64_t solve_ns) noexcept {
  state.planner.record(request, fresh, solve_ns, state.mail);
  if (fresh) state.mail.plans.publish();
  state.planning.solve.add_ns(solve_ns);
  ++state.planning.plans;
  control_loop::PlanningResult& result = state.mail.results.writer();
  result = state.planner.result();
  result.solve_ns = solve_ns;
  state.mail.results.publish();
}

void publish(ControllerState& state, const LoopStatistics& loop, const PlannerStatistics& planning) {
  if (state.telemetry_node != nullptr) state.telemetry_node->publish(loop, planning);
}

void flush_telemetry(ControllerState& state) {
  take_ticks(state);
  publish(state, state.loop, state.planning);
  if (state.telemetry_node != nullptr) state.telemetry_node->flush();
}

void check_goal(const Options& options, const ControllerState& state, Outcome& outcome) {
  if (!outcome.error.empty() || !state.script || !state.script->missed()) return;
  outcome.error = commissioning::formatted("--start: the robot did not get there within --duration %g s; ",
                                           options.duration_s) +
                  (outcome.waits.empty() ? "its last state was " + outcome.last_state : outcome.waits);
}

void take_statistics(const ControllerState& state, Outcome& outcome) {
  if (state.loop.ticks > 0) {
    const supervisor::SupervisorOutput& end = state.control.decision();
    take_end({state.control.time_s(), end.state, state.control.last_state(), end.latched},
             state.mail.events.dropped(), outcome);
  }
  outcome.ticks = state.loop.ticks;
  outcome.late_ticks = state.loop.late_ticks;
  outcome.missed_periods = state.loop.missed_periods;
  outcome.plans = state.planning.plans;
  outcome.wakeup_latency_us = state.loop.wakeup_latency.percentiles();
  outcome.execution_us = state.loop.execution.percentiles();
  outcome.bus_round_trip_us = state.loop.bus_round_trip.percentiles();
  outcome.solve_us = state.planning.solve.percentiles();
  outcome.heap_allocations = state.loop.heap_allocations + state.planning.heap_allocations;
  outcome.page_faults = state.loop.page_faults + state.planning.page_faults;
}

}  // namespace stilt::program
