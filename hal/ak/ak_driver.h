#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "hal/ak/ak_bring_up.h"
#include "hal/ak/ak_protocol.h"
#include "hal/can/bus_load.h"
#include "hal/can/identifiers.h"
#include "hal/driver/driver_limits.h"
#include "hal/driver/driver_reading.h"

/// An AK of version 3 as any driver of a joint: the functions of hal/README.md. It reports by its own clock.
namespace stilt::hal::ak {

/// A status is a reading. A position frame refines it where both agree within a step of the status, whichever
/// of the two comes first. Without a status between them, a second one is no new reading: its velocity is
/// old.
[[nodiscard]] DecodeStatus take_frame(const AkDriver& driver, const CanFrame& frame,
                                      DriverReading& reading) noexcept;
[[nodiscard]] EncodeStatus command_frame(const AkDriver& driver, const DriverCommand& command,
                                         CanFrame& frame) noexcept;
/// A limp command: it cannot be switched off, and follows this one for ever.
[[nodiscard]] inline EncodeStatus disable_frame(const AkDriver& driver, CanFrame& frame) noexcept {
  return encode_limp(driver, frame);
}

[[nodiscard]] constexpr std::optional<CanFrame> fault_reset_frame(const AkDriver&) noexcept {
  return std::nullopt;
}
[[nodiscard]] constexpr std::optional<CanFrame> question_frame(const AkDriver&, unsigned) noexcept {
  return std::nullopt;
}
[[nodiscard]] constexpr bool has_own_gains(const AkDriver&) noexcept { return true; }
[[nodiscard]] constexpr int extra_encoder(const AkDriver&) noexcept { return -1; }
[[nodiscard]] constexpr double report_rate_hz(const AkDriver& driver) noexcept {
  return driver.status_rate_hz;
}
/// Whether it keeps the turns of its rotor without power differs by model.
[[nodiscard]] constexpr bool counts_from_power_up(const AkDriver&) noexcept { return true; }
[[nodiscard]] constexpr std::uint32_t address(const AkDriver& driver) noexcept { return driver.id; }
[[nodiscard]] constexpr std::optional<ReplyId> reply_id(const AkDriver&) noexcept { return std::nullopt; }
[[nodiscard]] inline AkBringUp make_bring_up(const AkDriver& driver,
                                             const bring_up::Options& options) noexcept {
  return {driver, options};
}

/// Extended ones that end in its identifier.
[[nodiscard]] NodeIdentifiers identifiers(const AkDriver& driver);
[[nodiscard]] std::vector<FrameId> receive_ids(const AkDriver& driver);
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const AkDriver& driver, double tick_hz);
[[nodiscard]] constexpr DriverStandardIds standard_ids(const AkDriver&) noexcept { return {}; }
[[nodiscard]] constexpr bool uses_fd(const AkDriver&) noexcept { return false; }
[[nodiscard]] constexpr std::optional<GainLimits> gain_limits(const AkDriver& driver) noexcept {
  return GainLimits{.kp = driver.kp_Nm_rad,
                    .kd = driver.kd_Nms_rad,
                    .kp_step = kAkGainStep * driver.kp_Nm_rad,
                    .kd_step = kAkGainStep * driver.kd_Nms_rad};
}
[[nodiscard]] constexpr std::optional<FrameReach> frame_reach(const AkDriver& driver) noexcept {
  constexpr double kMost = 32767;
  return FrameReach{
      .command_position_rad = driver.position_rad,
      .command_velocity_rad_s = driver.velocity_rad_s,
      .command_torque_Nm = driver.torque_Nm,
      .reply_position_rad = kMost * kAkStatusStep_rad,
      .reply_velocity_rad_s = kMost * 10 * 2 * std::numbers::pi / 60 / driver.pole_pairs / driver.gear_ratio};
}

}  // namespace stilt::hal::ak
