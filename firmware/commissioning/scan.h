#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "firmware/configuration/hardware.h"
#include "hal/bring_up/bring_up.h"
#include "hal/can/frame_bus.h"
#include "hal/driver/read_setting.h"
#include "hal/driver/scanned_driver.h"
#include "hal/robot/clock.h"

/// Which drivers and sensors are on the buses of a configuration. No frame enables a motor: drivers get
/// questions, those of the MIT mode the frame that turns a motor off, which they answer. An encoder of the
/// torso on CANopen is started with NMT commands, SDO reads and SYNC. SDO writes set its transmission type,
/// which it does not store. Ordinary threads; why so: docs/decisions/0021-commissioning.md
namespace stilt::commissioning {

/// What came after questions under an identifier of their driver, and is no answer of its protocol.
struct UndecodedReply {
  std::uint32_t id = 0;
  int length = 0;  ///< bytes
};

/// A driver that the configuration names, or another that answered.
struct ScannedNode {
  std::optional<std::size_t> joint;  ///< nothing: not in the configuration of this bus
  std::string protocol;
  int id = 0;
  std::optional<int> expected_reply_id;  ///< by the configuration, where the driver has such a setting
  std::string firmware;                  ///< as the vendor writes it; empty: not reported
  hal::ScannedDriver found;
  std::optional<UndecodedReply> undecoded;  ///< the newest, of a driver of the configuration without answer
  /// Of a driver of the configuration, as far as it can be asked, and its keys of a watchdog.
  std::vector<hal::ReadSetting> settings;
  std::string several;           ///< why more than one driver has this identifier; empty: nothing shows that
  std::uint64_t bus_errors = 0;  ///< error frames of the bus while it was asked in vain

  [[nodiscard]] bool wrong_reply_id() const noexcept {
    return expected_reply_id && found.reply_id && static_cast<int>(*found.reply_id) != *expected_reply_id;
  }
  /// It alone answers, with the identifiers and settings of the configuration, and has no fault.
  [[nodiscard]] bool good() const noexcept {
    return found.answered && !wrong_reply_id() && found.reading.fault == hal::DriverFault::none &&
           several.empty() && std::ranges::all_of(settings, &hal::ReadSetting::right);
  }
};

/// Frames of one identifier that came unasked.
struct ScannedFrames {
  std::uint32_t id = 0;
  bool extended = false;
  double rate_hz = 0.0;
  double expected_hz = 0.0;  ///< by the configuration; 0: nothing expects them

  /// They come more rarely than the controller counts on: its readings would be late.
  [[nodiscard]] bool slow() const noexcept { return rate_hz < 0.8 * expected_hz; }
  /// They come more often: the controller would count missing ones late.
  [[nodiscard]] bool fast() const noexcept { return expected_hz > 0 && rate_hz > 1.5 * expected_hz; }
  /// The configuration names them, and they come as often as it states.
  [[nodiscard]] bool well() const noexcept { return rate_hz > 0 && !slow() && !fast(); }
};

/// What answers or sends on one bus.
struct ScannedBus {
  std::string name;
  std::vector<ScannedNode> expected;
  std::vector<ScannedNode> unexpected;
  std::vector<ScannedFrames> torso_sensor;  ///< those of the configuration, with the rates they came at
  std::string torso_trouble;  ///< why it does not report, where that is known; empty: nothing is
  std::vector<ScannedFrames> unknown;
  bool gone = false;             ///< while it was scanned
  bool off = false;              ///< its controller took itself off
  bool acknowledged = true;      ///< frames leave: somebody acknowledges them
  std::uint64_t bus_errors = 0;  ///< while a driver was asked in vain; 0 where nothing acknowledges
  bool asked_others = false;     ///< all identifiers outside the configuration were asked, too
  std::set<int> asked;           ///< identifiers that were asked, or looked for where drivers report
};

/// What all buses have.
struct ScanResult {
  std::vector<ScannedBus> buses;
  bool stopped = false;  ///< before its end: something was not asked
  std::string
      serial_sensor_trouble;  ///< of a torso sensor on a serial port, set by who reads it; empty: none
  /// Everything that the configuration names is there, well, and often enough, and nothing else. Another
  /// driver may move, and frames of another program may be commands.
  [[nodiscard]] bool complete() const noexcept;
};

/// Listens for 0.2 s per bus. Then asks every driver of the configuration for its identity and its settings,
/// and starts an encoder of the torso on CANopen. Then it asks other identifiers of the drivers' protocol,
/// none that the torso sensor uses. It does so only where all drivers of the bus speak one protocol.
/// @param wanted  of each joint: travel and speed at the driver's shaft, whether it needs a watchdog
/// @param buses  in the order of their numbers, receiving all identifiers
/// @param stop   ends the scan early
[[nodiscard]] ScanResult scan(const configuration::HardwareParameters& hardware,
                              const std::array<hal::bring_up::Options, hal::kJoints>& wanted,
                              std::span<hal::FrameBus* const> buses, hal::Clock& clock,
                              const std::atomic<bool>& stop);

[[nodiscard]] std::string to_text(const ScanResult& result);
[[nodiscard]] std::string to_json(const ScanResult& result);

}  // namespace stilt::commissioning
