#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/sensors/torso_sensor.h"

namespace stilt::hal {

/// How a torso sensor measures.
struct TorsoSensorTraits {
  std::uint32_t period_reads = 1;  ///< reads from one pitch, and one rate, to the next
  bool has_rate = true;            ///< false: the rate is that of the pitch over rate_window_s
  double rate_window_s = 0.01;     ///< 1 ms to 50 ms
  double pitch_period_rad = 0;     ///< the pitch repeats after this; 0: never
};

/// Pitch and pitch rate of the torso from whatever measures them. Unwraps the pitch, takes the rate from it
/// where the sensor has none, and counts the age of pitch and rate apart. Real-time safe.
///
/// Without a rate of the sensor: pitch_rate(t) = (pitch(t) - pitch(t - T)) / T with T = rate_window_s, the
/// mean rate of the window, that of T / 2 ago. Not a number until pitches fill the window. In a gap of T to
/// 50 ms the pitch is linear: the first rate after it is that of half the gap ago. A longer one begins anew.
class TorsoMeasurement {
 public:
  explicit TorsoMeasurement(const TorsoSensorTraits& traits) noexcept : traits_(traits) {}

  /// Once per read, before and after what has arrived is taken.
  void begin_read() noexcept { pitch_is_new_ = rate_is_new_ = false; }
  void end_read() noexcept;

  /// Before the pitch of the same moment.
  void set_rate(double pitch_rate_rad_s) noexcept;
  /// @param time_ns  when it was measured, as far as that is known
  void set_pitch(std::int64_t time_ns, double pitch_rad) noexcept;

  [[nodiscard]] bool pitch_is_new() const noexcept { return pitch_is_new_; }
  [[nodiscard]] const BaseReading& reading() const noexcept { return reading_; }
  /// For what else a sensor measures.
  [[nodiscard]] BaseReading& reading() noexcept { return reading_; }

 private:
  struct Sample {
    std::int64_t time_ns = 0;
    double pitch_rad = 0;
  };
  static constexpr std::size_t kSamples = 64;

  [[nodiscard]] double unwrapped_rad(double pitch_rad) const noexcept;
  void differentiate(const Sample& newest) noexcept;

  TorsoSensorTraits traits_;
  BaseReading reading_;
  double rate_at_pitch_rad_s_ = 0.0;  ///< when the newest pitch came
  bool pitch_is_new_ = false;
  bool rate_is_new_ = false;
  std::uint32_t pitch_silent_ = 0;  ///< reads in a row without a new pitch
  std::uint32_t rate_silent_ = 0;   ///< and without a new rate of the sensor
  std::array<Sample, kSamples> samples_{};
  std::size_t first_sample_ = 0;
  std::size_t sample_count_ = 0;
};

}  // namespace stilt::hal
