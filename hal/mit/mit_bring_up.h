#pragma once

#include "hal/bring_up/bring_up.h"
#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// Drivers in MIT mode. Damiao: everything through its registers (identifier, MIT mode, version, ranges,
/// timeout). Mini-cheetah and AK can only be asked for their state. They have no version, scaling or watchdog
/// to require, so they are refused unless Options::accept_missing_watchdog. A mini-cheetah keeps the newest
/// command while it is off and follows it once it is on: one of zero torque goes first. Whether an AK that is
/// off answers is not public: it is asked off and on in turn.
class MitBringUp final : public bring_up::BringUp {
 public:
  MitBringUp(const MitDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), driver_(driver) {}

 private:
  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  /// Without registers every reply is the same: only after silence it is known to which request.
  [[nodiscard]] bring_up::Stage lag_stage() const noexcept override {
    return has_registers() ? bring_up::Stage::identify : bring_up::Stage::home;
  }
  [[nodiscard]] CanFrame off_or_on() const noexcept;

  [[nodiscard]] bool has_registers() const noexcept { return driver_.layout == ReplyLayout::damiao; }
  [[nodiscard]] Ask ask_identity(unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_watchdog(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_enable(unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask limp(CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_register(DamiaoRegister number, CanFrame& frame) const noexcept;
  void suspect_settings(const CanFrame& frame) noexcept;
  [[nodiscard]] bool replies_with(std::uint16_t id, const CanFrame& frame) const noexcept;
  [[nodiscard]] Verdict judge_state(bring_up::Stage stage, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_register(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_range(unsigned part, double maximum) noexcept;

  MitDriver driver_;
};

}  // namespace stilt::hal::mit
