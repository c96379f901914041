#include "tests/firmware/commissioning/hanging_robot.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/robot_bring_up.h"
#include "firmware/robots/robots.h"
#include "host_tools/cli/robot_setup.h"

namespace stilt::commissioning::testing {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr double kGivesTorque_Nm = 0.2;  // more than a step of a frame
constexpr double kSeen_rad = 0.02;

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

configuration::Configuration configuration_of(const Wiring& wiring) {
  std::vector<configuration::Override> overrides;
  for (const std::string& setting : wiring.both) overrides.push_back({setting});
  const configuration::Result result = configuration::load_robot(wiring.name, overrides);
  if (!result) throw std::runtime_error(configuration::to_string(result.error()));
  return *result;
}

robot_on_bus::RobotSetup setup_of(const Wiring& wiring) {
  cli::RobotOptions options;
  options.robot = wiring.name;
  options.hang = true;
  options.settings = joined(wiring.both, wiring.robot);
  options.miswired = wiring.miswired;
  options.plant_settings = wiring.plant;
  options.seed = wiring.seed;
  robot_on_bus::RobotSetup setup = cli::simulated_hardware(options).setup;
  for (robot_on_bus::JointMistake& mistake : setup.mistakes) mistake.torque_factor = wiring.torque_factor;
  return setup;
}

const model::RobotModel& model_of(const configuration::Configuration& configuration) {
  const auto found = robots::find(configuration.hardware.robot);
  if (!found) throw std::runtime_error(found.error());
  return (*found)->model;
}

}  // namespace

HangingRobot::HangingRobot(const Wiring& wiring)
    : configuration(configuration_of(wiring)),
      robot(setup_of(wiring)),
      buses{DirectBus(robot, 0, now_ns_), DirectBus(robot, 1, now_ns_)} {
  const hal::RobotWiring own = configuration::robot_wiring(configuration.hardware, 1e9 / kTick_ns);
  const auto options = configuration::bring_up_options(
      configuration.hardware, model_of(configuration).constants, wiring.angles_known);
  hardware = std::make_unique<hal::RobotHardware>(own, options, frame_buses());
}

void HangingRobot::reference_to_rotors() {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    auto& driver = dynamic_cast<hal::moteus::MoteusEmulator&>(robot.drivers().driver(joint));
    driver.set_home(hal::moteus::MoteusHome::rotor);
  }
}

std::int64_t HangingRobot::sleep_until(std::int64_t time_ns) noexcept {
  while (now_ns_ < time_ns) {
    now_ns_ += kTick_ns;
    robot.tick(now_ns_);
    for (std::size_t bus = 0; bus < buses.size(); ++bus) {
      std::vector<hal::CanFrame> frames = robot.take_outgoing(now_ns_, bus);
      std::erase_if(frames, [this](const hal::CanFrame& frame) {
        return lost_id == frame.id && now_ns_ >= lost_from_ns;
      });
      buses[bus].waiting.insert(buses[bus].waiting.end(), frames.begin(), frames.end());
    }
    look();
    if (each_tick) each_tick();
  }
  return now_ns_;
}

void HangingRobot::look() {
  const model::StateVector state = robot.plant().state();
  hal::JointValues link_rad{};
  bool gives_torque = false;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const auto own = model::kFirstJoint + static_cast<int>(joint);
    link_rad[joint] = state[own] + (joint % 2 == 1 ? state[own - 1] : 0.0);
    const double torque_Nm = std::abs(robot.plant().applied_torque_Nm()[static_cast<int>(joint)]);
    peak_torque_Nm_[joint] = std::max(peak_torque_Nm_[joint], torque_Nm);
    gives_torque = gives_torque || torque_Nm > kGivesTorque_Nm;
  }
  if (!hung_rad_ && gives_torque) hung_rad_ = link_rad;
  if (!hung_rad_) return;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    const double moved_rad = link_rad[joint] - (*hung_rad_)[joint];
    farthest_rad_[joint] = std::max(farthest_rad_[joint], std::abs(moved_rad));
    if (first_link_ || std::abs(moved_rad) < kSeen_rad) continue;
    first_link_ = joint;
    first_way_ = moved_rad;
  }
}

std::array<hal::bring_up::Options, hal::kJoints> HangingRobot::wanted() const {
  std::array<hal::bring_up::Options, hal::kJoints> wanted;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    wanted[joint].accept_missing_watchdog =
        configuration::driver_of(configuration.hardware, joint).accept_missing_watchdog;
  }
  return wanted;
}

JogRequest HangingRobot::jog_request(std::size_t joint, double angle_rad) const {
  const model::RobotModel& model = model_of(configuration);
  return {.joint = joint,
          .angle_rad = angle_rad,
          .torque_limit_Nm = model.constants.torque_limit_Nm[joint],
          .push_Nm = first_push_Nm(model, joint),
          .kp_Nm_rad = configuration.supervisor.hold_kp_Nm_rad,
          .kd_Nms_rad = configuration.supervisor.hold_kd_Nms_rad,
          .supervisor = configuration.supervisor};
}

Sighting HangingRobot::sighting() const {
  Sighting seen;
  if (!first_link_) return seen;
  seen.link = first_link_;
  seen.way = first_way_ > 0 ? Way::backward : Way::forward;
  seen.angle_rad = farthest_rad_[*first_link_];
  return seen;
}

void HangingRobot::forget_sightings() {
  hung_rad_.reset();
  farthest_rad_.fill(0);
  first_link_.reset();
}

void stall_with_torque(HangingRobot& robot, std::int64_t stall_ns) {
  robot.each_tick = [&robot, stall_ns, stalled = false]() mutable {
    if (stalled || robot.peak_torque_Nm(0) < 0.5) return;
    stalled = true;
    static_cast<void>(robot.sleep_until(robot.now_ns() + stall_ns));
  };
}

void Onlooker::ask(const std::string& question) {
  const Sighting seen = robot_.sighting();
  if (question.starts_with("Which link")) {
    answer_ = seen.link ? link_name(*seen.link) : "none";
  } else if (question.starts_with("Which way")) {
    answer_ = seen.way == Way::backward ? "backward" : "forward";
  } else {
    answer_ = std::to_string(std::lround(seen.angle_rad.value_or(0.0) * 180.0 / M_PI));
  }
}

}  // namespace stilt::commissioning::testing
