#include "hal/robot/can_drivers.h"

#include <algorithm>
#include <optional>

namespace stilt::hal {

using bring_up::Stage;

namespace {

JointBringUp make(const JointDriver& driver, const bring_up::Options& options) noexcept {
  return visit_driver(driver, [&](const auto& any) -> JointBringUp { return make_bring_up(any, options); });
}

/// As long as damps the joints by default. No driver is known to restart sooner.
constexpr unsigned kMayHaveRestarted_reads = 10;

/// An absolute encoder whose one turn fits the joint's travel is referenced by that at each bring-up.
bool loses_zero(const JointDriver& driver, const bring_up::Options& options) noexcept {
  return options.encoder_period_rad == 0 &&
         visit_driver(driver, [](const auto& any) { return counts_from_power_up(any); });
}

}  // namespace

CanDrivers::CanDrivers(const RobotWiring& wiring, const BringUpOptions& options, std::span<TapBus> taps,
                       CanRobot& robot) noexcept
    : wiring_(wiring),
      taps_(taps),
      robot_(robot),
      bring_up_{make(wiring.joints[0].driver, options[0]), make(wiring.joints[1].driver, options[1]),
                make(wiring.joints[2].driver, options[2]), make(wiring.joints[3].driver, options[3])} {
  for (std::size_t joint = 0; joint < kJoints; ++joint)
    loses_zero_[joint] = loses_zero(wiring.joints[joint].driver, options[joint]);
}

bring_up::BringUp& CanDrivers::of(std::size_t joint) noexcept {
  return visit_driver(bring_up_[joint], [](auto& any) -> bring_up::BringUp& { return any; });
}

void CanDrivers::begin() noexcept {
  for (std::size_t joint = 0; joint < kJoints; ++joint) of(joint).restart();
  for (TapBus& tap : taps_) tap.forget();
  beginning_ = true;
}

void CanDrivers::clear_latched_faults() noexcept {
  for (const JointWiring& joint : wiring_.joints) {
    const std::optional<CanFrame> frame =
        visit_driver(joint.driver, [](const auto& driver) { return fault_reset_frame(driver); });
    if (frame) static_cast<void>(taps_[joint.bus].send(std::span(&*frame, 1)));
  }
}

bool CanDrivers::must_wait(std::size_t joint) noexcept {
  for (std::size_t other = 0; other < joint; ++other) {
    if (wiring_.joints[other].bus == wiring_.joints[joint].bus && of(other).stage() != Stage::ready)
      return true;
  }
  return false;
}

/// Between its steps bring-up asks one driver at a time, and feeds those that are ready.
bool CanDrivers::answers(std::size_t joint) noexcept {
  return !stepped_ || reports_by_itself(wiring_.joints[joint].driver) || of(joint).stage() == Stage::ready;
}

void CanDrivers::watch() noexcept {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const bool missed = robot_.missed_reports(joint) > 0 && answers(joint);
    silent_reads_[joint] = missed ? silent_reads_[joint] + 1 : 0;
    const bool restarted = robot_.has_started(joint) || silent_reads_[joint] >= kMayHaveRestarted_reads;
    if (restarted && was_up_[joint] && loses_zero_[joint]) offset_is_void_[joint] = true;
  }
  stepped_ = false;
}

std::optional<std::size_t> CanDrivers::void_offset() const noexcept {
  const auto* const is_void = std::ranges::find(offset_is_void_, true);
  if (is_void == offset_is_void_.end()) return std::nullopt;
  return static_cast<std::size_t>(is_void - offset_is_void_.begin());
}

void CanDrivers::step_joint(std::int64_t now_ns, std::size_t joint, BringUpProgress& progress) noexcept {
  TapBus& tap = taps_[wiring_.joints[joint].bus];
  const bring_up::StepResult result = of(joint).step(now_ns, tap.kept());
  if (result.send) static_cast<void>(tap.send(std::span(&result.frame, 1)));
  if (result.stage == Stage::ready) {
    was_up_[joint] = true;
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
  progress.fault_code = result.fault_code;
  progress.setting = result.setting;
  progress.version = result.version;
  progress.wanted_version = result.wanted_version;
  progress.reply_lag_s = 1e-9 * static_cast<double>(result.reply_lag_ns);
}

BringUpProgress CanDrivers::step(std::int64_t now_ns) noexcept {
  BringUpProgress progress;
  stepped_ = true;
  if (const std::optional<std::size_t> joint = void_offset()) {
    progress.failed = true;
    progress.joint = *joint;
    progress.stage = Stage::failed;
    progress.failure = bring_up::Failure::void_offsets;
    return progress;
  }
  progress.stage = Stage::ready;
  progress.ready = true;
  if (beginning_) {
    clear_latched_faults();
    beginning_ = false;
    rest_until_ns_ = now_ns + bring_up::BringUp::kRest_ns;
  }
  if (now_ns < rest_until_ns_) {
    progress.ready = false;
    progress.stage = Stage::identify;
  } else {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      if (!must_wait(joint)) step_joint(now_ns, joint, progress);
    }
  }
  for (TapBus& tap : taps_) tap.forget();
  return progress;
}

}  // namespace stilt::hal
