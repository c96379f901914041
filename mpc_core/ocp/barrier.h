#pragma once

#include <bit>
#include <cstdint>

#include "mpc_core/model/batch.h"
#include "mpc_core/ocp/parameters.h"

/// Relaxed logarithmic barriers for inequalities h >= 0 on batches of nodes:
///
///   B(h) = -mu ln h                                        h > delta
///        = mu (-ln delta + ((h - 2 delta)/delta)^2 / 2 - 1/2)   otherwise
///
/// twice continuously differentiable, finite for every h. Source: Hauser and Saccon 2006, "A barrier function
/// method for the optimization of trajectory functionals with constraints". Real-time safe.
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

/// First and second derivative of one barrier.
struct BarrierSlope {
  Batch first;
  Batch second;
};

[[nodiscard]] inline BarrierSlope barrier_slope(const BarrierParameters& p, const Batch& h) noexcept {
  const Batch inverse = 1.0 / h;
  BarrierSlope slope{-p.mu * inverse, p.mu * inverse * inverse};
  const auto relaxed = !(h > p.delta);
  where(relaxed, slope.first) = p.mu / (p.delta * p.delta) * (h - 2.0 * p.delta);
  where(relaxed, slope.second) = Batch(p.mu / (p.delta * p.delta));
  return slope;
}

/// Sum of barriers that share their parameters: one logarithm for the product of up to 16 of them.
class BarrierSum {
 public:
  explicit BarrierSum(const BarrierParameters& parameters) noexcept : p_(parameters) {}

  void add(const Batch& h) noexcept {
    const auto relaxed = !(h > p_.delta);
    Batch clipped = h * (1.0 / p_.delta);
    Batch quadratic = clipped - 2.0;
    quadratic = 0.5 * quadratic * quadratic - 0.5;
    where(relaxed, clipped) = Batch(1.0);
    where(!relaxed, quadratic) = Batch(0.0);
    product_ *= clipped;
    relaxed_ += quadratic;
    ++count_;
  }

  [[nodiscard]] Batch value() const noexcept {
    return p_.mu * (relaxed_ - logarithm(product_) - count_ * log_delta());
  }

 private:
  /// ln delta by the same routine, so that the constant matches the lanes.
  [[nodiscard]] Batch log_delta() const noexcept { return logarithm(Batch(p_.delta)); }

  BarrierParameters p_;
  Batch product_ = Batch(1.0);
  Batch relaxed_ = Batch(0.0);
  double count_ = 0.0;
};

}  // namespace stilt::ocp
