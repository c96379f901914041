#pragma once

#include <optional>

namespace stilt::log {

/// The mean speed of a run counts from this time after its start.
inline constexpr double kSettled_s = 3.0;

/// Mean speed of a run after its first 3 s, or of all of it when it is no longer.
class MeanSpeed {
 public:
  /// Call with the position of the hip in order of time.
  void add(double time_s, double x_m) {
    last_ = {time_s, x_m};
    if (!from_) from_ = last_;
    if (!settled_ && time_s - from_->time_s >= kSettled_s) settled_ = last_;
  }

  [[nodiscard]] double value_m_s() const {
    if (!from_) return 0.0;
    const Place& from = settled_ && last_.time_s > settled_->time_s ? *settled_ : *from_;
    return last_.time_s > from.time_s ? (last_.x_m - from.x_m) / (last_.time_s - from.time_s) : 0.0;
  }

 private:
  struct Place {
    double time_s = 0.0, x_m = 0.0;
  };
  std::optional<Place> from_, settled_;
  Place last_;
};

}  // namespace stilt::log
