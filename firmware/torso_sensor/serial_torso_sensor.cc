#include "firmware/torso_sensor/serial_torso_sensor.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <utility>

#include "hal/robot/clock.h"

// Why a thread of its own: docs/decisions/0004-hardware-abstraction.md
namespace stilt::torso_sensor {
namespace {

constexpr std::int64_t kWait_ns = 50'000'000;     // bounds the time to stop
constexpr std::int64_t kReopen_ns = 200'000'000;  // between two tries
constexpr std::int64_t kSilence_ns = 500'000'000;
constexpr std::size_t kBatch = 256;

}  // namespace

std::string sentence(SerialTrouble trouble, const SerialSettings& settings) {
  if (trouble == SerialTrouble::none) return "";
  std::string port = "torso sensor: serial port " + settings.port;
  switch (trouble) {
    case SerialTrouble::none:
      break;
    case SerialTrouble::gone:
      return port +
             " is gone; plug the sensor in again, and stiltd opens it under that name, which may be one "
             "of /dev/serial/by-id";
    case SerialTrouble::silent:
      return port + " is silent; see the sensor's power and cable";
    case SerialTrouble::no_packet:
      return port +
             " carries bytes and no binary messages with yaw, pitch and roll; see "
             "torso_sensor.serial_baud, and register 75 of the sensor (docs/deployment.md)";
    case SerialTrouble::no_rate:
      return port +
             " carries messages without angular rates; see register 75 of the sensor "
             "(docs/deployment.md)";
  }
  return port;
}

std::expected<void, std::string> SerialTorsoSensor::start(const SerialSettings& settings) {
  settings_ = settings;
  auto port = hal::serial::SerialPort::open(settings.port, settings.bit_rate_bit_s);
  if (!port) return std::unexpected(port.error());
  port_.emplace(std::move(*port));
  if (!thread_.start({"torso sensor", settings.priority, -1}, work, this))
    return std::unexpected("the thread of the torso sensor cannot be started");
  return {};
}

void SerialTorsoSensor::stop() {
  end_.store(true, std::memory_order_relaxed);
  thread_.join();
}

std::string SerialTorsoSensor::trouble_sentence() const {
  const SerialTrouble now = trouble();
  if (now == SerialTrouble::gone) {
    const std::lock_guard lock(mutex_);
    if (!not_opened_.empty()) return "torso sensor: " + not_opened_;
  }
  return sentence(now, settings_);
}

void SerialTorsoSensor::work(void* self) { static_cast<SerialTorsoSensor*>(self)->run(); }

void SerialTorsoSensor::run() {
  hal::MonotonicClock clock;
  newest_byte_ns_ = newest_packet_ns_ = clock.now_ns();
  while (!end_.load(std::memory_order_relaxed)) {
    if (port_) {
      listen();
    } else {
      reopen();
    }
  }
}

void SerialTorsoSensor::listen() noexcept {
  hal::MonotonicClock clock;
  std::array<std::uint8_t, kBatch> bytes;
  const bool readable = port_->wait(kWait_ns);
  const std::int64_t now_ns = clock.now_ns();
  const std::ptrdiff_t count = readable ? port_->read(bytes) : 0;
  if (count < 0 || (readable && count == 0)) {  // readable without bytes: hung up
    port_.reset();
    trouble_.store(SerialTrouble::gone, std::memory_order_relaxed);
    return;
  }
  if (count > 0) newest_byte_ns_ = now_ns;
  static_cast<void>(stream_.push(std::span(bytes).first(static_cast<std::size_t>(count))));
  hal::vectornav::Packet packet;
  while (stream_.next(packet)) take(now_ns, packet);
  judge(now_ns);
}

void SerialTorsoSensor::take(std::int64_t now_ns, const hal::vectornav::Packet& packet) noexcept {
  const hal::vectornav::Pitch pitch = pitch_of(packet, settings_.mounting);
  newest_packet_ns_ = now_ns;
  sample_.pitch_rad = pitch.angle_rad;
  sample_.pitch_rate_rad_s = pitch.rate_rad_s;
  sample_.time_ns = now_ns;
  ++sample_.number;
  sample_.malformed = stream_.malformed();
  samples_.writer() = sample_;
  samples_.publish();
}

void SerialTorsoSensor::judge(std::int64_t now_ns) noexcept {
  SerialTrouble trouble = SerialTrouble::none;
  if (now_ns - newest_byte_ns_ > kSilence_ns) {
    trouble = SerialTrouble::silent;
  } else if (now_ns - newest_packet_ns_ > kSilence_ns) {
    trouble = SerialTrouble::no_packet;
  } else if (sample_.number > 0 && std::isnan(sample_.pitch_rate_rad_s)) {
    trouble = SerialTrouble::no_rate;
  }
  trouble_.store(trouble, std::memory_order_relaxed);
}

void SerialTorsoSensor::reopen() {
  hal::MonotonicClock clock;
  static_cast<void>(clock.sleep_until(clock.now_ns() + kReopen_ns));
  const bool there = access(settings_.port.c_str(), F_OK) == 0;
  auto port = hal::serial::SerialPort::open(settings_.port, settings_.bit_rate_bit_s);
  {
    const std::lock_guard lock(mutex_);
    not_opened_ = there && !port ? port.error() : "";
  }
  if (port) port_.emplace(std::move(*port));
}

}  // namespace stilt::torso_sensor
