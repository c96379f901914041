#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "hal/mit/mit_bring_up.h"
#include "hal/moteus/moteus_bring_up.h"
#include "hal/odrive/odrive_bring_up.h"
#include "hal/robot/can_robot.h"
#include "hal/robot/robot.h"
#include "hal/robot/robot_wiring.h"
#include "hal/robot/tap_bus.h"

namespace stilt::hardware {

/// What the bring-up of one driver shall insist on.
struct DriverDemands {
  hal::bring_up::Options options;
  hal::bring_up::OdriveEndpoints endpoints;
};

using DemandsOfJoints = std::array<DriverDemands, hal::kJoints>;

/// Drivers on buses: the step functions of hal/bring_up, one driver a bus at a time (drivers of one maker
/// share identifiers while they are asked for registers). Fixed memory.
class CanDrivers final {
 public:
  /// @param taps   one a bus, read by `robot`; outlive this object
  /// @param robot  told about whole turns of the encoders
  CanDrivers(const hal::RobotWiring& wiring, const DemandsOfJoints& demands, std::span<TapBus> taps,
             hal::CanRobot& robot) noexcept;

  /// Starts over, from whatever state the drivers are in.
  void begin() noexcept;
  /// One step, once per tick, after the buses were read and instead of a command.
  [[nodiscard]] hal::BringUpProgress step(std::int64_t now_ns) noexcept;

 private:
  using AnyBringUp =
      std::variant<hal::bring_up::MitBringUp, hal::bring_up::MoteusBringUp, hal::bring_up::OdriveBringUp>;

  [[nodiscard]] static AnyBringUp make(const hal::JointWiring& wiring, const DriverDemands& demands) noexcept;
  [[nodiscard]] hal::bring_up::BringUp& of(std::size_t joint) noexcept;
  void clear_latched_faults() noexcept;
  /// Whether an earlier driver on the same bus is still at work.
  [[nodiscard]] bool must_wait(std::size_t joint) noexcept;
  void step_joint(std::int64_t now_ns, std::size_t joint, hal::BringUpProgress& progress) noexcept;

  hal::RobotWiring wiring_;
  std::span<TapBus> taps_;
  hal::CanRobot& robot_;
  std::array<AnyBringUp, hal::kJoints> bring_up_;
  bool beginning_ = true;
};

}  // namespace stilt::hardware
