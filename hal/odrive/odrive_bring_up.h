#pragma once

#include <cstdint>

#include "hal/bring_up/bring_up.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// ODrive: checks the firmware, selects torque control, writes watchdog and its switch and reads both back
/// (only possible when the endpoints are known: otherwise it has none to promise), and enables closed-loop
/// control.
class OdriveBringUp final : public bring_up::BringUp {
 public:
  OdriveBringUp(const OdriveDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), node_(driver.node), endpoints_(driver.endpoints) {}

 private:
  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  [[nodiscard]] bool knows_endpoints() const noexcept {
    return endpoints_.watchdog_timeout != 0 && endpoints_.enable_watchdog != 0;
  }
  [[nodiscard]] Ask ask_watchdog(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_enable(unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask asked(EncodeStatus status, Ask kind) noexcept;
  [[nodiscard]] Verdict judge_version(const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_watchdog(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_enable(const CanFrame& frame) noexcept;

  std::uint8_t node_;
  OdriveEndpoints endpoints_;
};

}  // namespace stilt::hal::odrive
