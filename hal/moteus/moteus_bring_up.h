#pragma once

#include <cstddef>

#include "hal/bring_up/absolute_turn.h"
#include "hal/bring_up/bring_up.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_console.h"

namespace stilt::hal::moteus {

/// moteus: stops it, which clears faults and an expired watchdog. Checks firmware and register map version,
/// and reads the settings that no register shows over its command line. Writes the watchdog register and
/// reads it back. The position must be referenced to the output, or to the rotor with an encoder period
/// that leaves one turn. For a joint without a travel the rotor is enough. Then position mode is enabled at
/// zero gain and torque. Enabled at zero torque it is asked to hold both ends of the joint's travel. Its
/// control position shows bounds and limits of the trajectory. The terms of its torque, which its limit of 0
/// keeps from the motor, show the gains.
class MoteusBringUp final : public bring_up::BringUp {
 public:
  MoteusBringUp(const MoteusDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), driver_(driver) {}

  /// Whether the position is that of the joint, and not of any turn of the rotor. For a driver that is ready.
  [[nodiscard]] bool turn_known() const noexcept {
    return !rotor_referenced_ || !any_turn(options().minimum_angle_rad, options().maximum_angle_rad);
  }

 private:
  /// Parts of enable: position mode, then probes of the two ends of the travel.
  static constexpr unsigned kLowerEnd = 1;
  static constexpr unsigned kUpperEnd = 2;

  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  [[nodiscard]] Verdict judge_setting(const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_version(const MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict judge_home(const MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict judge_enabling(const MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict judge_probe(const MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict wrong(bring_up::Failure failure, const Blame& blame = {}) noexcept;
  [[nodiscard]] double end_rad(bool lower) const noexcept;
  [[nodiscard]] double probed_rad() const noexcept { return end_rad(part() == kLowerEnd); }
  [[nodiscard]] bool reaches_both_ends() const noexcept;
  [[nodiscard]] bring_up::Setting contradicted(const MoteusReply& reply) noexcept;

  MoteusDriver driver_;
  bool output_referenced_ = false;
  bool rotor_referenced_ = false;
  double last_control_rad_ = 0;
  std::size_t setting_ = 0;  ///< that is asked for
  ConsoleReader console_;
};

}  // namespace stilt::hal::moteus
