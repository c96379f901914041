#pragma once

#include <cstdint>

#include "hal/bring_up/bring_up.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::bring_up {

/// Numbers of the parameters, from flat_endpoints.json of the firmware's release; 0: unknown.
struct OdriveEndpoints {
  std::uint16_t watchdog_timeout = 0;  ///< axis0.config.watchdog_timeout, float, s
  std::uint16_t enable_watchdog = 0;   ///< axis0.config.enable_watchdog, bool
};

/// ODrive: checks the firmware, selects torque control, writes watchdog and its switch and reads both back
/// (only possible when the endpoints are known: otherwise it has none to promise), and enables closed-loop
/// control.
class OdriveBringUp final : public BringUp {
 public:
  OdriveBringUp(std::uint8_t node, const OdriveEndpoints& endpoints, const Options& options) noexcept
      : BringUp(options), node_(node), endpoints_(endpoints) {}

 private:
  [[nodiscard]] Ask ask(Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  [[nodiscard]] bool knows_endpoints() const noexcept {
    return endpoints_.watchdog_timeout != 0 && endpoints_.enable_watchdog != 0;
  }
  [[nodiscard]] Ask ask_watchdog(Stage stage, unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_enable(unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask asked(protocol::EncodeStatus status, Ask kind) noexcept;
  [[nodiscard]] Verdict judge_version(const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_watchdog(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_enable(const CanFrame& frame) noexcept;

  std::uint8_t node_;
  OdriveEndpoints endpoints_;
};

}  // namespace stilt::hal::bring_up
