#pragma once

#include "hal/driver/emulated_driver.h"
#include "hal/odrive/odrive_cansimple.h"

namespace stilt::hal::odrive {

/// ODrive with torque control: heartbeat and estimates on a timer, parameters for the watchdog, which is off
/// at first and disarms the axis when it expires.
class OdriveEmulator final : public EmulatedDriver {
 public:
  explicit OdriveEmulator(const OdriveDriver& driver,
                          const OdriveVersion& version = {2, 4, 4, 58, 0, 6, 11, 0}) noexcept
      : node_(driver.node), endpoints_(driver.endpoints), version_(version) {}

  void take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) noexcept override;
  void elapse(std::int64_t now_ns, FrameSink& replies) noexcept override;
  [[nodiscard]] double torque_Nm() const noexcept override { return enabled() && powered() ? torque_Nm_ : 0; }
  [[nodiscard]] bool enabled() const noexcept override;
  [[nodiscard]] bool reports_supply() const noexcept override { return true; }
  void raise(DriverFault fault) noexcept override;
  void power_cycle() noexcept override;

  static constexpr std::int64_t kEstimatesPeriod_ns = 1'000'000;
  static constexpr std::int64_t kHeartbeatPeriod_ns = 100'000'000;

 private:
  void disarm(std::uint32_t error) noexcept;
  void answer_request(OdriveCommand what, FrameSink& replies) const noexcept;
  void take_parameter(const OdriveParameter& request, FrameSink& replies) noexcept;
  void take_command(std::int64_t now_ns, OdriveCommand command, const CanFrame& frame,
                    FrameSink& replies) noexcept;

  std::uint8_t node_;
  OdriveEndpoints endpoints_;
  OdriveVersion version_;
  std::uint32_t errors_ = 0;
  std::uint32_t state_ = static_cast<std::uint32_t>(OdriveState::idle);
  double torque_Nm_ = 0;
  float watchdog_s_ = 0;
  bool watchdog_enabled_ = false;
  std::int64_t fed_ns_ = 0;
  std::int64_t next_estimates_ns_ = 0;
  std::int64_t next_heartbeat_ns_ = 0;
};

[[nodiscard]] inline OdriveEmulator make_emulator(const OdriveDriver& driver) noexcept {
  return OdriveEmulator(driver);
}

}  // namespace stilt::hal::odrive
