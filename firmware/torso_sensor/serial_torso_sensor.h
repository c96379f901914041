#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <mutex>
#include <optional>
#include <string>

#include "firmware/exchange/latest_value.h"
#include "firmware/realtime/thread.h"
#include "hal/sensors/torso_feed.h"
#include "hal/serial/serial_port.h"
#include "hal/vectornav/vectornav.h"

namespace stilt::torso_sensor {

/// The port of a torso sensor, and how the sensor is mounted.
struct SerialSettings {
  std::string port;
  int bit_rate_bit_s = 921600;
  hal::vectornav::Mounting mounting{};
  int priority = 0;  ///< SCHED_FIFO of its thread; 0: ordinary
};

/// Why the sensor does not report.
enum class SerialTrouble : std::uint8_t {
  none,
  gone,       ///< the port cannot be read, and is opened again now and then
  silent,     ///< no bytes
  no_packet,  ///< bytes, and no message in them
  no_rate,    ///< messages without angular rates
};
[[nodiscard]] std::string sentence(SerialTrouble trouble, const SerialSettings& settings);

/// A VectorNav on a serial port, read on a thread of its own. The terminals of the kernel take locks, and a
/// torque loop must not wait for them. What it measured last goes to the torque loop through a wait-free
/// exchange.
class SerialTorsoSensor final : public hal::TorsoFeed {
 public:
  SerialTorsoSensor() = default;
  SerialTorsoSensor(const SerialTorsoSensor&) = delete;
  SerialTorsoSensor& operator=(const SerialTorsoSensor&) = delete;
  ~SerialTorsoSensor() { stop(); }

  /// Opens the port and begins to read it. The error is one sentence for the user. Start-up only.
  [[nodiscard]] std::expected<void, std::string> start(const SerialSettings& settings);
  /// At exit.
  void stop();

  /// One thread alone, the torque loop's.
  [[nodiscard]] const hal::TorsoSample& newest() noexcept override { return samples_.newest(); }

  /// From any thread.
  [[nodiscard]] SerialTrouble trouble() const noexcept { return trouble_.load(std::memory_order_relaxed); }
  /// The trouble for the user, with the reason of a port that is there and cannot be opened; empty: none.
  [[nodiscard]] std::string trouble_sentence() const;

 private:
  static void work(void* self);
  void run();
  void listen() noexcept;
  void take(std::int64_t now_ns, const hal::vectornav::Packet& packet) noexcept;
  void judge(std::int64_t now_ns) noexcept;
  void reopen();

  SerialSettings settings_;
  std::optional<hal::serial::SerialPort> port_;
  hal::vectornav::Stream stream_;
  hal::TorsoSample sample_;
  std::int64_t newest_byte_ns_ = 0;
  std::int64_t newest_packet_ns_ = 0;
  exchange::LatestValue<hal::TorsoSample> samples_;
  std::atomic<SerialTrouble> trouble_ = SerialTrouble::none;
  std::atomic<bool> end_ = false;
  mutable std::mutex mutex_;
  std::string not_opened_;  ///< why the port that is there again cannot be opened; under the mutex
  realtime::Thread thread_;
};

}  // namespace stilt::torso_sensor
