#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/commissioning/jog_dialog.h"
#include "firmware/configuration/configuration.h"
#include "hal/robot/robot_hardware.h"
#include "host_tools/simulation/robot_on_bus/robot_on_bus.h"
#include "tests/host_tools/simulation/robot_on_bus/direct_bus.h"

namespace stilt::commissioning::testing {

/// What is simulated, and how it differs from the configuration that the commands have.
struct Wiring {
  std::vector<std::string> both;   ///< settings of robot and commands
  std::vector<std::string> robot;  ///< settings of the robot alone: mistakes
  std::vector<std::string> miswired;
  std::vector<std::string> plant = {};  ///< options of the plant
  double torque_factor = 1.0;           ///< torque that the motors give, over what their drivers report
  int seed = 1;                         ///< of the sensors' noise
  bool angles_known = false;            ///< to the commands, as to identify
  std::string name = "amber3m";         ///< of a shipped robot
};

using robot_on_bus::testing_support::DirectBus;

/// Settings of drivers of an AK of version 3 at all joints, with the ranges that this robot needs.
inline const std::vector<std::string> kAkV3 = {"hip_driver.protocol=ak_v3",
                                               "knee_driver.protocol=ak_v3",
                                               "hip_driver.position_range_rad=12.56",
                                               "knee_driver.position_range_rad=12.56",
                                               "hip_driver.accept_missing_watchdog=true",
                                               "knee_driver.accept_missing_watchdog=true"};

/// Settings of ODrives with a watchdog.
inline const std::vector<std::string> kOdriveWithWatchdog = {
    "hip_driver.protocol=odrive",
    "knee_driver.protocol=odrive",
    "hip_driver.odrive_watchdog_timeout_endpoint=17",
    "knee_driver.odrive_watchdog_timeout_endpoint=17",
    "hip_driver.odrive_enable_watchdog_endpoint=18",
    "knee_driver.odrive_enable_watchdog_endpoint=18",
    "hip_driver.odrive_firmware_version=0.6.11",
    "knee_driver.odrive_firmware_version=0.6.11",
    "hip_driver.odrive_hardware_version=4.4.58",
    "knee_driver.odrive_hardware_version=4.4.58"};

/// A simulated robot that hangs, its legs free, as the commands meet it. Its clock advances it. It keeps
/// what a person would see of its links, and the largest torque of each joint.
class HangingRobot final : public hal::Clock {
 public:
  explicit HangingRobot(const Wiring& wiring = {});

  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  [[nodiscard]] std::int64_t sleep_until(std::int64_t time_ns) noexcept override;

  [[nodiscard]] std::vector<hal::FrameBus*> frame_buses() { return {&buses[0], &buses[1]}; }
  [[nodiscard]] Session session(const DriverLimits& limits = {}) {
    return {*hardware, *this, 1'000'000, stop, limits};
  }
  /// All drivers are moteus that have the encoder of their rotor alone.
  void reference_to_rotors();
  /// For a scan: any travel and speed, and a watchdog where the configuration requires one.
  [[nodiscard]] std::array<hal::bring_up::Options, hal::kJoints> wanted() const;
  [[nodiscard]] JogRequest jog_request(std::size_t joint, double angle_rad) const;

  /// Of the links' angles in the world, from where they hung when the first motor gave torque. It is the link
  /// that moved first, which way, and how far it went.
  [[nodiscard]] Sighting sighting() const;
  /// Before another jog.
  void forget_sightings();
  [[nodiscard]] double peak_torque_Nm(std::size_t joint) const { return peak_torque_Nm_[joint]; }

  configuration::Configuration configuration;  ///< that of the commands
  robot_on_bus::RobotOnBus robot;
  std::array<DirectBus, 2> buses;
  std::unique_ptr<hal::RobotHardware> hardware;
  std::atomic<bool> stop = false;
  std::optional<std::uint32_t> lost_id;  ///< frames of it do not arrive
  std::int64_t lost_from_ns = 0;         ///< from then on
  std::function<void()> each_tick;       ///< after the robot's

 private:
  void look();

  std::int64_t now_ns_ = 1'000'000'000;
  hal::JointValues peak_torque_Nm_{};
  std::optional<hal::JointValues> hung_rad_;  ///< angles of the links
  hal::JointValues farthest_rad_{};
  std::optional<std::size_t> first_link_;
  double first_way_ = 0.0;
};

/// The program stands still once, for so long, when the left hip has torque; the robot goes on.
void stall_with_torque(HangingRobot& robot, std::int64_t stall_ns);

/// Answers from what the robot's links did.
class Onlooker final : public Person {
 public:
  explicit Onlooker(const HangingRobot& robot) : robot_(robot) {}

  void ask(const std::string& question) override;
  [[nodiscard]] std::optional<std::string> answer() override { return std::exchange(answer_, std::nullopt); }
  [[nodiscard]] bool gone() const override { return false; }
  [[nodiscard]] bool patient() const override { return false; }

 private:
  const HangingRobot& robot_;
  std::optional<std::string> answer_;
};

}  // namespace stilt::commissioning::testing
