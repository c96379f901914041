#pragma once

#include <array>
#include <cstdint>

#include "hal/bring_up/bring_up.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// ODrive: checks firmware and hardware, selects torque control, writes watchdog and its switch and reads
/// both back. That needs the endpoints; without them the driver has no watchdog. Their numbers are those of
/// one firmware for one hardware, so nothing is written to another, nor where no such values were. Then it
/// measures how often the driver reports, and enables closed-loop control. That shows in the heartbeat alone,
/// which answers no request; torques of 0 feed the watchdog meanwhile.
///
/// Any parameter reads back what was written. So it stops feeding at zero torque, until the heartbeat reports
/// the expired watchdog, and enables once more. A driver that goes on is turned off, gets its old values, and
/// is refused. In closed loop, because firmware 0.5 counts in idle, too, and of 0.6 only this is public:
/// github.com/odriverobotics/ros_odrive, issue 10, and odrive_botwheel_explorer/README.md.
class OdriveBringUp final : public bring_up::BringUp {
 public:
  OdriveBringUp(const OdriveDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), node_(driver.node), endpoints_(driver.endpoints) {}

 private:
  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;
  [[nodiscard]] bool undo(unsigned part, CanFrame& frame) noexcept override;
  /// Heartbeats and estimates, which it sends unasked, identify it.
  [[nodiscard]] bring_up::Stage lag_stage() const noexcept override { return bring_up::Stage::version; }
  /// Its state comes with heartbeats only, by default every 100 ms.
  [[nodiscard]] std::int64_t longest_silence_ns() const noexcept override { return 250'000'000; }

  [[nodiscard]] bool knows_endpoints() const noexcept {
    return endpoints_.watchdog_timeout != 0 && endpoints_.enable_watchdog != 0;
  }
  [[nodiscard]] Ask ask_watchdog(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_torque_mode(CanFrame& frame) noexcept;
  [[nodiscard]] Ask ask_enable(unsigned part, CanFrame& frame) noexcept;
  [[nodiscard]] Ask asked(EncodeStatus status, Ask kind) noexcept;
  [[nodiscard]] Ask ask_rates() noexcept;
  [[nodiscard]] Ask ask_silence() noexcept;
  [[nodiscard]] Verdict judge_version(const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_old_value(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_watchdog(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] std::uint16_t checked_endpoint(unsigned part) const noexcept;
  [[nodiscard]] Verdict judge_limits(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_home(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_enable(const CanFrame& frame) noexcept;

  std::uint8_t node_;
  OdriveEndpoints endpoints_;
  unsigned listened_ = 0;                    ///< times
  unsigned estimates_ = 0;                   ///< while listening
  unsigned heartbeats_ = 0;                  ///< while listening
  unsigned torques_ = 0;                     ///< while listening
  bool mode_sent_ = false;                   ///< since the last try of closed loop
  std::array<std::uint32_t, 2> old_bits_{};  ///< of time and switch, before they were written
  bool written_ = false;                     ///< time or switch
  bool proved_ = false;                      ///< the watchdog has ended closed loop, or none is configured
  bool silent_ = false;                      ///< in closed loop, until the watchdog ends that
  unsigned silences_ = 0;                    ///< times
};

}  // namespace stilt::hal::odrive
