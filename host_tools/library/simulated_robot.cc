#include "host_tools/simulation/plant/simulated_robot.h"

#include <stilt/simulated_robot.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "firmware/library/read_settings.h"
#include "firmware/robots/robots.h"
#include "host_tools/simulation/closed_loop/plant_robot.h"
#include "host_tools/simulation/plant/stance.h"

/// The simulated robot of the library: docs/decisions/0034-library.md.
namespace stilt {
namespace {

using simulation::Plant;
using simulation::PlantOptions;

/// On its feet at the height of the reference, on the world's ground.
model::StateVector standing(const PlantOptions& world, const model::RobotConstants& robot,
                            const configuration::Configuration& configuration) {
  const double half_width_m = configuration.gait.stand_half_width_m;
  return simulation::standing_state(
      {robot.thigh_length_m, robot.shin_length_m}, configuration.reference.base_height_m, half_width_m,
      {simulation::ground_height_m(world, half_width_m), simulation::ground_height_m(world, -half_width_m)});
}

}  // namespace

struct SimulatedRobot::Parts {
  Parts(const robots::Robot& robot, const PlantOptions& world,
        const configuration::Configuration& configuration, std::uint64_t seed, double period_s)
      : plant(simulation::make_plant_model(robot.tree, world, configuration.reference.base_height_m), world,
              seed),
        drivers(plant, {}, period_s),
        steps(static_cast<int>(std::lround(period_s / plant.time_step_s()))),
        tick_s(period_s) {
    plant.set_state(standing(world, robot.model.constants, configuration));
  }

  Plant plant;
  simulation::PlantRobot drivers;
  hal::RobotReadings readings;
  int steps;
  double tick_s;
  long long ticks = 0;
};

SimulatedRobot::SimulatedRobot(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
SimulatedRobot::SimulatedRobot(SimulatedRobot&&) noexcept = default;
SimulatedRobot& SimulatedRobot::operator=(SimulatedRobot&&) noexcept = default;
SimulatedRobot::~SimulatedRobot() = default;

std::expected<SimulatedRobot, std::string> SimulatedRobot::create(const Settings& settings,
                                                                  const std::vector<std::string>& plant,
                                                                  std::uint64_t seed) try {
  const auto configuration = library::read_settings(settings);
  if (!configuration) return std::unexpected(configuration.error());
  const auto robot = robots::find(configuration->hardware.robot);
  if (!robot) return std::unexpected(robot.error());
  PlantOptions world;
  for (const std::string& assignment : plant) simulation::set_plant_option(world, assignment);
  const double tick_s = 1.0 / configuration->timing.torque_rate_hz;
  world.time_step_s = simulation::time_step_for_tick(world.time_step_s, tick_s);
  return SimulatedRobot(std::make_unique<Parts>(**robot, world, *configuration, seed, tick_s));
} catch (const std::exception& error) {
  return std::unexpected(library::with_library_names(error.what()));
}

Measurements SimulatedRobot::read() {
  Parts& p = *parts_;
  p.drivers.read(1 + p.ticks, p.readings);
  Measurements measurements;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const hal::JointReading& joint = p.readings.joints[i];
    measurements.joints[i] = {joint.position_rad, joint.velocity_rad_s, joint.torque_Nm};
  }
  measurements.pitch_rad = p.readings.base.pitch_rad;
  measurements.pitch_rate_rad_s = p.readings.base.pitch_rate_rad_s;
  return measurements;
}

void SimulatedRobot::drive(const Tick& tick) {
  Parts& p = *parts_;
  switch (tick.action) {
    case DriverAction::none:
      break;
    case DriverAction::enable:
      static_cast<void>(p.drivers.bring_up(1 + p.ticks));
      break;
    case DriverAction::targets: {
      hal::JointCommands commands{};
      for (std::size_t i = 0; i < kJointCount; ++i) {
        const JointTarget& target = tick.targets[i];
        commands[i] = {target.position_rad, target.velocity_rad_s, target.torque_Nm,
                       target.kp_Nm_rad,    target.kd_Nms_rad,     target.torque_limit_Nm};
      }
      static_cast<void>(p.drivers.write(commands));
      break;
    }
    case DriverAction::disable:
      static_cast<void>(p.drivers.disable());
      break;
  }
}

void SimulatedRobot::advance() {
  for (int step = 0; step < parts_->steps; ++step) {
    parts_->drivers.drive();
    parts_->plant.step();
  }
  ++parts_->ticks;
}

void SimulatedRobot::push(double force_N) { parts_->plant.set_push(force_N, simulation::PushPoint::hip); }

double SimulatedRobot::time_s() const noexcept { return static_cast<double>(parts_->ticks) * parts_->tick_s; }

double SimulatedRobot::hip_x_m() const { return parts_->plant.state()[0]; }

bool SimulatedRobot::fallen() const { return parts_->plant.fall() != simulation::Fall::none; }

std::array<double, kStateCount> SimulatedRobot::state() const {
  const model::StateVector state = parts_->plant.state();
  std::array<double, kStateCount> values;
  std::copy(state.begin(), state.end(), values.begin());
  return values;
}

}  // namespace stilt
