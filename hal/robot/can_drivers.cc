#include "hal/robot/can_drivers.h"

namespace stilt::hardware {

using hal::bring_up::Stage;

CanDrivers::AnyBringUp CanDrivers::make(const hal::JointWiring& wiring,
                                        const DriverDemands& demands) noexcept {
  if (const auto* mit = std::get_if<hal::protocol::MitDriver>(&wiring.driver)) {
    return hal::bring_up::MitBringUp(*mit, demands.options);
  }
  if (const auto* moteus = std::get_if<hal::protocol::MoteusDriver>(&wiring.driver)) {
    return hal::bring_up::MoteusBringUp(*moteus, demands.options);
  }
  const auto* odrive = std::get_if<hal::OdriveNode>(&wiring.driver);
  return hal::bring_up::OdriveBringUp(odrive->node, demands.endpoints, demands.options);
}

CanDrivers::CanDrivers(const hal::RobotWiring& wiring, const DemandsOfJoints& demands, std::span<TapBus> taps,
                       hal::CanRobot& robot) noexcept
    : wiring_(wiring),
      taps_(taps),
      robot_(robot),
      bring_up_{make(wiring.joints[0], demands[0]), make(wiring.joints[1], demands[1]),
                make(wiring.joints[2], demands[2]), make(wiring.joints[3], demands[3])} {}

hal::bring_up::BringUp& CanDrivers::of(std::size_t joint) noexcept {
  AnyBringUp& any = bring_up_[joint];
  if (auto* mit = std::get_if<hal::bring_up::MitBringUp>(&any)) return *mit;
  if (auto* moteus = std::get_if<hal::bring_up::MoteusBringUp>(&any)) return *moteus;
  return *std::get_if<hal::bring_up::OdriveBringUp>(&any);
}

void CanDrivers::begin() noexcept {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) of(joint).restart();
  for (TapBus& tap : taps_) tap.forget();
  beginning_ = true;
}

/// A Damiao keeps the expiry of its watchdog until it is told otherwise; the others clear faults when
/// stopped.
void CanDrivers::clear_latched_faults() noexcept {
  for (const hal::JointWiring& joint : wiring_.joints) {
    const auto* mit = std::get_if<hal::protocol::MitDriver>(&joint.driver);
    if (mit == nullptr || mit->layout != hal::protocol::ReplyLayout::damiao) continue;
    const hal::CanFrame frame = special_frame(*mit, hal::protocol::MitSpecial::clear_error);
    static_cast<void>(taps_[joint.bus].send(std::span(&frame, 1)));
  }
}

bool CanDrivers::must_wait(std::size_t joint) noexcept {
  for (std::size_t other = 0; other < joint; ++other) {
    if (wiring_.joints[other].bus == wiring_.joints[joint].bus && of(other).stage() != Stage::ready)
      return true;
  }
  return false;
}

void CanDrivers::step_joint(std::int64_t now_ns, std::size_t joint, hal::BringUpProgress& progress) noexcept {
  TapBus& tap = taps_[wiring_.joints[joint].bus];
  const hal::bring_up::StepResult result = of(joint).step(now_ns, tap.kept());
  if (result.send) static_cast<void>(tap.send(std::span(&result.frame, 1)));
  if (result.stage == Stage::ready) {
    robot_.set_turn_offset(joint, result.turn_offset_rad);
    return;
  }
  progress.ready = false;
  if (progress.failed) return;
  progress.failed = result.stage == Stage::failed;
  progress.joint = joint;
  progress.stage = result.stage;
  progress.failure = result.failure;
  progress.fault = result.driver_fault;
}

hal::BringUpProgress CanDrivers::step(std::int64_t now_ns) noexcept {
  hal::BringUpProgress progress;
  progress.stage = Stage::ready;
  progress.ready = true;
  if (beginning_) {
    clear_latched_faults();
    beginning_ = false;
    progress.ready = false;
    progress.stage = Stage::identify;
  } else {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (!must_wait(joint)) step_joint(now_ns, joint, progress);
    }
  }
  for (TapBus& tap : taps_) tap.forget();
  return progress;
}

}  // namespace stilt::hardware
