#pragma once

#include <bit>
#include <cstdint>

#include "mpc_core/model/batch.h"
#include "mpc_core/ocp/parameters.h"

// clang-format off
/// Relaxed logarithmic barriers for inequalities h >= 0 on batches of nodes:
///
///   B(h) = -w ln h                                 h > d
///        = w (-ln d + ((h - 2 d)/d)^2 / 2 - 1/2)   otherwise
///
/// with the barrier weight w and the barrier width d. B is twice continuously differentiable and finite for
/// every h. Source: Hauser and Saccon 2006, "A barrier function method for the optimization of trajectory
/// functionals with constraints". Real-time safe.
// clang-format on
namespace stilt::ocp {

using model::Batch;

/// Natural logarithm of each lane; x positive, finite and normal. Relative error below 4e-16.
/// x = 2^e m with m in [1/sqrt 2, sqrt 2), ln m = 2 artanh((m - 1)/(m + 1)) by its series.
[[nodiscard]] inline Batch logarithm(const Batch& x) noexcept {
  using Bits = std::experimental::rebind_simd_t<std::uint64_t, Batch>;
  constexpr double kLn2 = 0.693147180559945309417232121458;
  constexpr double kSqrt2 = 1.41421356237309504880168872421;
  const Bits bits = std::bit_cast<Bits>(x);
  // A biased exponent placed in the low bits of 2^52 becomes a double by subtraction.
  const Bits exponent_bits = (bits >> 52) | Bits(0x4330000000000000ULL);
  Batch exponent = std::bit_cast<Batch>(exponent_bits) - Batch(4503599627370496.0 + 1023.0);
  Batch m = std::bit_cast<Batch>((bits & Bits(0x000fffffffffffffULL)) | Bits(0x3ff0000000000000ULL));
  const auto upper = m > kSqrt2;
  where(upper, m) = 0.5 * m;
  where(upper, exponent) = exponent + 1.0;
  const Batch s = (m - 1.0) / (m + 1.0);
  const Batch z = s * s;
  Batch series = Batch(1.0 / 21.0);
  for (int k = 19; k >= 1; k -= 2) series = series * z + 1.0 / k;
  return exponent * kLn2 + 2.0 * s * series;
}

/// First and second derivative of a barrier, or of a sum of them.
struct BarrierSlope {
  Batch first;
  Batch second;
};

/// Parameters of a barrier, and the second derivative w / d^2 of its quadratic.
struct BarrierCurve {
  explicit BarrierCurve(const BarrierParameters& p) noexcept
      : weight(p.weight), width(p.width), relaxed(p.weight / (p.width * p.width)) {}

  double weight;
  double width;
  double relaxed;
};

/// First and second derivatives of two barriers that share their parameters, each by its own argument. Both
/// use one division: h is clamped at d. There the quadratic has the second derivative of the logarithm,
/// and the first derivative needs the correction w / d^2 (h - d).
struct BarrierPair {
  BarrierSlope a;
  BarrierSlope b;

  BarrierPair(const BarrierCurve& p, const Batch& h_a, const Batch& h_b) noexcept {
    const Batch cut_a = max(h_a, Batch(p.width));
    const Batch cut_b = max(h_b, Batch(p.width));
    const Batch inverse = 1.0 / (cut_a * cut_b);
    const Batch inverse_a = cut_b * inverse;
    const Batch inverse_b = cut_a * inverse;
    a = {p.relaxed * (h_a - cut_a) - p.weight * inverse_a, p.weight * inverse_a * inverse_a};
    b = {p.relaxed * (h_b - cut_b) - p.weight * inverse_b, p.weight * inverse_b * inverse_b};
  }
};

/// Derivatives, by the value, of the barriers of lower <= value <= upper.
[[nodiscard]] inline BarrierSlope limit_slope(const BarrierCurve& p, const Batch& value, double lower,
                                              double upper) noexcept {
  const BarrierPair pair(p, value - lower, upper - value);
  return {pair.a.first - pair.b.first, pair.a.second + pair.b.second};
}

/// Parameters of a barrier, and the logarithm of its width by the routine used for the lanes.
struct BarrierConstants {
  explicit BarrierConstants(const BarrierParameters& parameters) noexcept
      : p(parameters), inverse_width(1.0 / p.width), log_width(logarithm(Batch(p.width))) {}

  BarrierParameters p;
  double inverse_width;
  Batch log_width;
};

/// Sum of barriers that share their parameters: one logarithm of the product for up to 16 of them.
class BarrierSum {
 public:
  explicit BarrierSum(const BarrierConstants& constants) noexcept : constants_(constants) {}

  void add(const Batch& h) noexcept {
    const Batch t = h * constants_.inverse_width;
    const Batch cut = max(t, Batch(1.0));
    const Batch below = t - cut;  // <= 0; the quadratic is its square / 2 minus itself
    product_ *= cut;
    relaxed_ += below * (0.5 * below - 1.0);
    ++count_;
  }

  [[nodiscard]] Batch value() const noexcept {
    return constants_.p.weight * (relaxed_ - logarithm(product_) - count_ * constants_.log_width);
  }

 private:
  const BarrierConstants& constants_;
  Batch product_ = Batch(1.0);
  Batch relaxed_ = Batch(0.0);
  double count_ = 0.0;
};

}  // namespace stilt::ocp
