#pragma once

#include <optional>
#include <vector>

#include "hal/can/bus_load.h"
#include "hal/can/identifiers.h"
#include "hal/driver/driver_limits.h"
#include "hal/driver/driver_reading.h"
#include "hal/mit/mit_bring_up.h"
#include "hal/mit/mit_mode.h"

/// A driver in MIT mode as any driver of a joint: the functions of hal/README.md.
namespace stilt::hal::mit {

[[nodiscard]] DecodeStatus take_frame(const MitDriver& driver, const CanFrame& frame,
                                      DriverReading& reading) noexcept;
[[nodiscard]] EncodeStatus command_frame(const MitDriver& driver, const DriverCommand& command,
                                         CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus disable_frame(const MitDriver& driver, CanFrame& frame) noexcept;

/// A Damiao keeps the expiry of its watchdog until it is cleared.
[[nodiscard]] std::optional<CanFrame> fault_reset_frame(const MitDriver& driver) noexcept;
[[nodiscard]] constexpr std::optional<CanFrame> question_frame(const MitDriver&, unsigned) noexcept {
  return std::nullopt;
}
[[nodiscard]] constexpr bool has_own_gains(const MitDriver&) noexcept { return true; }
[[nodiscard]] constexpr int extra_encoder(const MitDriver&) noexcept { return -1; }
[[nodiscard]] constexpr double report_rate_hz(const MitDriver&) noexcept { return 0; }
/// The others count turns of the rotor; a Damiao has an encoder at its output.
[[nodiscard]] constexpr bool counts_from_power_up(const MitDriver& driver) noexcept {
  return driver.layout != ReplyLayout::damiao;
}
[[nodiscard]] constexpr std::uint32_t address(const MitDriver& driver) noexcept { return driver.command_id; }
[[nodiscard]] constexpr std::optional<ReplyId> reply_id(const MitDriver& driver) noexcept {
  return ReplyId{{driver.reply_id, false}, sender_mask(driver), driver.driver_id};
}
[[nodiscard]] inline MitBringUp make_bring_up(const MitDriver& driver,
                                              const bring_up::Options& options) noexcept {
  return {driver, options};
}

/// Two identifiers, of a Damiao also that of its registers.
[[nodiscard]] NodeIdentifiers identifiers(const MitDriver& driver);
[[nodiscard]] std::vector<FrameId> receive_ids(const MitDriver& driver);
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const MitDriver& driver, double tick_hz);
/// Of its frames both ways; of a Damiao also its registers.
[[nodiscard]] constexpr DriverStandardIds standard_ids(const MitDriver& driver) noexcept {
  const std::uint32_t registers = driver.layout == ReplyLayout::damiao ? kMaximumStandardId : 0;
  return {{{driver.command_id, kMaximumStandardId},
           {driver.reply_id, kMaximumStandardId},
           {kMaximumStandardId, registers}}};
}
[[nodiscard]] constexpr bool uses_fd(const MitDriver&) noexcept { return false; }
[[nodiscard]] constexpr std::optional<GainLimits> gain_limits(const MitDriver& driver) noexcept {
  return GainLimits{.kp = driver.kp_Nm_rad.maximum,
                    .kd = driver.kd_Nms_rad.maximum,
                    .kp_step = step(driver.kp_Nm_rad, 12),
                    .kd_step = step(driver.kd_Nms_rad, 12)};
}
[[nodiscard]] constexpr std::optional<FrameReach> frame_reach(const MitDriver& driver) noexcept {
  return FrameReach{.command_position_rad = driver.position_rad.maximum,
                    .command_velocity_rad_s = driver.velocity_rad_s.maximum,
                    .command_torque_Nm = driver.torque_Nm.maximum,
                    .reply_position_rad = driver.reply_position_rad.maximum,
                    .reply_velocity_rad_s = driver.reply_velocity_rad_s.maximum};
}

}  // namespace stilt::hal::mit
