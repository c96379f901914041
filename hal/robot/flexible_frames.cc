#include "hal/robot/flexible_frames.h"

namespace stilt::hal {

FlexibleFrames::FlexibleFrames(const RobotWiring& wiring, std::size_t bus) noexcept {
  for (const JointWiring& joint : wiring.joints) {
    if (joint.bus != bus || !joint.can_fd) continue;
    for (const StandardIds& ids :
         visit_driver(joint.driver, [](const auto& driver) { return standard_ids(driver); })) {
      if (ids.mask != 0) add({ids.value, ids.mask, joint.bit_rate_switch});
    }
  }
}

void FlexibleFrames::add(Identifiers identifiers) noexcept {
  if (count_ < identifiers_.size()) identifiers_[count_++] = identifiers;
}

const FlexibleFrames::Identifiers* FlexibleFrames::find(const CanFrame& frame) const noexcept {
  if (frame.extended || frame.remote || frame.error) return nullptr;
  for (std::size_t i = 0; i < count_; ++i) {
    if ((frame.id & identifiers_[i].mask) == identifiers_[i].value) return &identifiers_[i];
  }
  return nullptr;
}

CanFrame FlexibleFrames::to_bus(const CanFrame& frame) const noexcept {
  CanFrame flexible = frame;
  if (const Identifiers* found = find(frame); found != nullptr) {
    flexible.fd = true;
    flexible.bit_rate_switch = found->bit_rate_switch;
  }
  return flexible;
}

CanFrame FlexibleFrames::from_bus(const CanFrame& frame) const noexcept {
  CanFrame classic = frame;
  if (frame.fd && frame.length <= kClassicFrameBytes && find(frame) != nullptr) {
    classic.fd = classic.bit_rate_switch = false;
  }
  return classic;
}

}  // namespace stilt::hal
