#pragma once

#include <optional>
#include <vector>

#include "hal/can/bus_load.h"
#include "hal/can/identifiers.h"
#include "hal/driver/driver_limits.h"
#include "hal/driver/driver_reading.h"
#include "hal/odrive/odrive_bring_up.h"
#include "hal/odrive/odrive_cansimple.h"

/// An ODrive as any driver of a joint: the functions of hal/README.md. It has no gains of its own and gets
/// the torque of the law; it is asked for supply and temperatures now and then.
namespace stilt::hal::odrive {

inline constexpr double kOdriveEstimates_hz = 1000;  ///< encoder_msg_rate_ms = 1

[[nodiscard]] DecodeStatus take_frame(const OdriveDriver& driver, const CanFrame& frame,
                                      DriverReading& reading) noexcept;
[[nodiscard]] EncodeStatus command_frame(const OdriveDriver& driver, const DriverCommand& command,
                                         CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus disable_frame(const OdriveDriver& driver, CanFrame& frame) noexcept;

/// It keeps its errors until they are cleared.
[[nodiscard]] std::optional<CanFrame> fault_reset_frame(const OdriveDriver& driver) noexcept;
/// It reports supply and temperatures on request, or when its own configuration sends them.
[[nodiscard]] std::optional<CanFrame> question_frame(const OdriveDriver& driver, unsigned question) noexcept;
[[nodiscard]] constexpr bool has_own_gains(const OdriveDriver&) noexcept { return false; }
[[nodiscard]] constexpr int extra_encoder(const OdriveDriver&) noexcept { return -1; }
/// Of its estimates, by its own clock: bring-up requires that rate.
[[nodiscard]] constexpr double report_rate_hz(const OdriveDriver&) noexcept { return kOdriveEstimates_hz; }
[[nodiscard]] constexpr bool counts_from_power_up(const OdriveDriver&) noexcept { return true; }
[[nodiscard]] constexpr std::uint32_t address(const OdriveDriver& driver) noexcept { return driver.node; }
[[nodiscard]] constexpr std::optional<ReplyId> reply_id(const OdriveDriver&) noexcept { return std::nullopt; }
[[nodiscard]] inline OdriveBringUp make_bring_up(const OdriveDriver& driver,
                                                 const bring_up::Options& options) noexcept {
  return {driver, options};
}

/// 32 identifiers per node, and those of node 63, which every ODrive accepts.
[[nodiscard]] NodeIdentifiers identifiers(const OdriveDriver& driver);
[[nodiscard]] std::vector<FrameId> receive_ids(const OdriveDriver& driver);
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const OdriveDriver& driver, double tick_hz);
/// All of its node.
[[nodiscard]] constexpr DriverStandardIds standard_ids(const OdriveDriver& driver) noexcept {
  return {{{static_cast<std::uint32_t>(driver.node) << 5, 0x7e0}, {}, {}}};
}
[[nodiscard]] constexpr bool uses_fd(const OdriveDriver&) noexcept { return false; }
/// The law is computed here, without ranges.
[[nodiscard]] constexpr std::optional<GainLimits> gain_limits(const OdriveDriver&) noexcept {
  return std::nullopt;
}
/// Floats.
[[nodiscard]] constexpr std::optional<FrameReach> frame_reach(const OdriveDriver&) noexcept {
  return std::nullopt;
}

}  // namespace stilt::hal::odrive
