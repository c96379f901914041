#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "hal/can/bus_load.h"
#include "hal/can/identifiers.h"
#include "hal/driver/driver_limits.h"
#include "hal/driver/driver_reading.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_bring_up.h"

/// A moteus as any driver of a joint: the functions of hal/README.md.
namespace stilt::hal::moteus {

[[nodiscard]] DecodeStatus take_frame(const MoteusDriver& driver, const CanFrame& frame,
                                      DriverReading& reading) noexcept;
[[nodiscard]] EncodeStatus command_frame(const MoteusDriver& driver, const DriverCommand& command,
                                         CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus disable_frame(const MoteusDriver& driver, CanFrame& frame) noexcept;

/// A stop clears faults: bring-up sends one.
[[nodiscard]] constexpr std::optional<CanFrame> fault_reset_frame(const MoteusDriver&) noexcept {
  return std::nullopt;
}
/// A frame beside the command would have its identifier, and wait for its echo: the command itself asks.
[[nodiscard]] constexpr std::optional<CanFrame> question_frame(const MoteusDriver&, unsigned) noexcept {
  return std::nullopt;
}
[[nodiscard]] constexpr bool has_own_gains(const MoteusDriver&) noexcept { return true; }
[[nodiscard]] constexpr int extra_encoder(const MoteusDriver& driver) noexcept {
  return driver.extra_encoder;
}
[[nodiscard]] constexpr double report_rate_hz(const MoteusDriver&) noexcept { return 0; }
/// Bring-up reads what its position is referenced to.
[[nodiscard]] constexpr bool counts_from_power_up(const MoteusDriver&) noexcept { return false; }
[[nodiscard]] constexpr std::uint32_t address(const MoteusDriver& driver) noexcept { return driver.id; }
[[nodiscard]] constexpr std::optional<ReplyId> reply_id(const MoteusDriver& driver) noexcept {
  const std::uint32_t id = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  return ReplyId{{id, id > kMaximumStandardId}};
}
[[nodiscard]] inline MoteusBringUp make_bring_up(const MoteusDriver& driver,
                                                 const bring_up::Options& options) noexcept {
  return {driver, options};
}

/// Accepts whatever has its own number in the last 8 bits.
[[nodiscard]] NodeIdentifiers identifiers(const MoteusDriver& driver);
[[nodiscard]] std::vector<FrameId> receive_ids(const MoteusDriver& driver);
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const MoteusDriver& driver, double tick_hz);
/// None: its frames are CAN FD frames by themselves.
[[nodiscard]] constexpr DriverStandardIds standard_ids(const MoteusDriver&) noexcept { return {}; }
[[nodiscard]] constexpr bool uses_fd(const MoteusDriver&) noexcept { return true; }
[[nodiscard]] constexpr std::optional<GainLimits> gain_limits(const MoteusDriver& driver) noexcept {
  return GainLimits{.kp = driver.kp_Nm_rev,
                    .kd = driver.kd_Nm_s_rev,
                    .kp_step = kScaleStep * driver.kp_Nm_rev,
                    .kd_step = kScaleStep * driver.kd_Nm_s_rev,
                    .unit_rad = 2 * std::numbers::pi,
                    .kp_unit = "Nm/rev",
                    .kd_unit = "Nm s/rev"};
}

/// Commands are int16, replies int32.
[[nodiscard]] constexpr std::optional<FrameReach> frame_reach(const MoteusDriver&) noexcept {
  constexpr double kReply_rad = 21474.8 * 2 * std::numbers::pi;
  return FrameReach{.command_position_rad = kMoteusPosition_rad,
                    .command_velocity_rad_s = kMoteusVelocity_rad_s,
                    .command_torque_Nm = kMoteusTorque_Nm,
                    .reply_position_rad = kReply_rad,
                    .reply_velocity_rad_s = kReply_rad};
}

}  // namespace stilt::hal::moteus
