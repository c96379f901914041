#pragma once

#include "hal/bring_up/bring_up.h"
#include "hal/moteus/moteus.h"

namespace stilt::hal::moteus {

/// moteus: stops it (which clears faults and an expired watchdog), checks firmware and register map version,
/// writes the watchdog register and reads it back, wants a position referenced to the output (or to the rotor
/// with an encoder period that leaves one turn), and enables position mode at zero gain and torque.
class MoteusBringUp final : public bring_up::BringUp {
 public:
  MoteusBringUp(const MoteusDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), driver_(driver) {}

 private:
  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  [[nodiscard]] Verdict judge_home(const MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict wrong(bring_up::Failure failure, DriverFault fault = DriverFault::none) noexcept;

  MoteusDriver driver_;
  bool output_referenced_ = false;
  bool rotor_referenced_ = false;
};

}  // namespace stilt::hal::moteus
