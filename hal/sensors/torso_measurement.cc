#include "hal/sensors/torso_measurement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stilt::hal {
namespace {

/// The jitter of the reads may make a window so much shorter.
constexpr std::int64_t kJitter_ns = 250'000;
/// The longest gap of a sensor of 100 Hz that supervisor.missed_damp_ticks = 40 passes, the most patience in
/// docs/deployment.md. With the shipped 10, a gap longer than the window is damped from 20 ms on.
constexpr std::int64_t kLongestGap_ns = 50'000'000;

}  // namespace

/// A sensor slower than the reads is only missed once its next value is due. Its rate may come apart from its
/// pitch: the older of the two counts.
void TorsoMeasurement::end_read() noexcept {
  pitch_silent_ = pitch_is_new_ ? 0 : pitch_silent_ + 1;
  rate_silent_ = rate_is_new_ || !traits_.has_rate ? 0 : rate_silent_ + 1;
  const std::uint32_t silent = std::max(pitch_silent_, rate_silent_);
  const std::uint32_t between = traits_.period_reads - 1;
  reading_.missed_replies = silent > between ? silent - between : 0;
}

void TorsoMeasurement::set_rate(double pitch_rate_rad_s) noexcept {
  reading_.pitch_rate_rad_s = pitch_rate_rad_s;
  rate_is_new_ = true;
}

/// Next to the last one; the first next to upright.
double TorsoMeasurement::unwrapped_rad(double pitch_rad) const noexcept {
  if (traits_.pitch_period_rad <= 0) return pitch_rad;
  const double near_rad = std::isfinite(reading_.pitch_rad) ? reading_.pitch_rad : 0;
  return near_rad + std::remainder(pitch_rad - near_rad, traits_.pitch_period_rad);
}

/// A pitch alone stays equal over many readings of a coarse sensor.
void TorsoMeasurement::set_pitch(std::int64_t time_ns, double pitch_rad) noexcept {
  const Sample newest{time_ns, unwrapped_rad(pitch_rad)};
  if (!traits_.has_rate) differentiate(newest);
  const double rate_rad_s = reading_.pitch_rate_rad_s;
  const bool same_rate = rate_rad_s == rate_at_pitch_rad_s_ || std::isnan(rate_rad_s);
  const bool same = newest.pitch_rad == reading_.pitch_rad && same_rate;
  reading_.unchanged_replies = same ? reading_.unchanged_replies + traits_.period_reads : 0;
  rate_at_pitch_rad_s_ = rate_rad_s;
  reading_.pitch_rad = newest.pitch_rad;
  reading_.time_ns = time_ns;
  pitch_is_new_ = true;
}

/// A window that begins in a gap begins on the line across it. The pitch comes without the gap's delay, and
/// the rate is as new as the pitch. No age shows that it is the mean of a longer time.
void TorsoMeasurement::differentiate(const Sample& newest) noexcept {
  const auto window_ns = static_cast<std::int64_t>(1e9 * traits_.rate_window_s) - kJitter_ns;
  const auto at = [this](std::size_t i) -> const Sample& { return samples_[(first_sample_ + i) % kSamples]; };
  // After a long gap the old samples say nothing of now.
  if (sample_count_ > 0 && newest.time_ns - at(sample_count_ - 1).time_ns > kLongestGap_ns) sample_count_ = 0;
  if (sample_count_ == kSamples) {
    first_sample_ = (first_sample_ + 1) % kSamples;
    --sample_count_;
  }
  samples_[(first_sample_ + sample_count_++) % kSamples] = newest;
  while (sample_count_ > 2 && newest.time_ns - at(1).time_ns >= window_ns) {
    first_sample_ = (first_sample_ + 1) % kSamples;
    --sample_count_;
  }
  Sample oldest = at(0);
  if (sample_count_ > 1 && at(1).time_ns - oldest.time_ns > window_ns) {
    const double gap_ns = static_cast<double>(at(1).time_ns - oldest.time_ns);
    const std::int64_t into_gap_ns = newest.time_ns - window_ns - oldest.time_ns;
    oldest.pitch_rad += static_cast<double>(into_gap_ns) / gap_ns * (at(1).pitch_rad - oldest.pitch_rad);
    oldest.time_ns += into_gap_ns;
  }
  const std::int64_t span_ns = newest.time_ns - oldest.time_ns;
  reading_.pitch_rate_rad_s = span_ns >= window_ns && span_ns > 0 ? (newest.pitch_rad - oldest.pitch_rad) /
                                                                        (1e-9 * static_cast<double>(span_ns))
                                                                  : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stilt::hal
