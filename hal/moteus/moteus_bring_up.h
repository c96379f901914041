#pragma once

#include "hal/bring_up/bring_up.h"
#include "hal/moteus/moteus.h"

namespace stilt::hal::bring_up {

/// moteus: stops it (which clears faults and an expired watchdog), checks firmware and register map version,
/// writes the watchdog register and reads it back, wants a position referenced to the output (or to the rotor
/// with an encoder period that leaves one turn), and enables position mode at zero gain and torque.
class MoteusBringUp final : public BringUp {
 public:
  MoteusBringUp(const protocol::MoteusDriver& driver, const Options& options) noexcept
      : BringUp(options), driver_(driver) {}

 private:
  [[nodiscard]] Ask ask(Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override;

  [[nodiscard]] Verdict judge_home(const protocol::MoteusReply& reply) noexcept;
  [[nodiscard]] Verdict wrong(Failure failure, DriverFault fault = DriverFault::none) noexcept;

  protocol::MoteusDriver driver_;
  bool output_referenced_ = false;
  bool rotor_referenced_ = false;
};

}  // namespace stilt::hal::bring_up
