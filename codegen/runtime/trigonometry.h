#pragma once

#include <bit>
#include <cstdint>
#include <experimental/simd>

/// Sine and cosine for the generated functions. Double and SIMD batches use one algorithm, so that a batch
/// gives the same results as its lanes one by one.
namespace stilt::runtime {

namespace detail {

inline double select(bool condition, double a, double b) noexcept { return condition ? a : b; }

template <class Abi>
inline std::experimental::simd<double, Abi> select(const std::experimental::simd_mask<double, Abi>& condition,
                                                   const std::experimental::simd<double, Abi>& a,
                                                   const std::experimental::simd<double, Abi>& b) noexcept {
  std::experimental::simd<double, Abi> result = b;
  std::experimental::where(condition, result) = a;
  return result;
}

/// Type of the 64-bit unsigned integers with the bits of T.
template <class T>
struct Bits {
  using type = std::uint64_t;
};
template <class Abi>
struct Bits<std::experimental::simd<double, Abi>> {
  using type = std::experimental::rebind_simd_t<std::uint64_t, std::experimental::simd<double, Abi>>;
};

}  // namespace detail

/// sine = sin(angle), cosine = cos(angle), angle in rad. T is double or a std::experimental::simd<double,
/// Abi> of one register.
///
/// The error is at most 2 units in the last place for |angle| <= 1e4. The result is NaN for NaN, infinities
/// and |angle| > 1e5, where the reduction would lose accuracy. No branch, no table; real-time safe.
///
/// angle = n pi/2 + r with |r| <= pi/4. pi/2 is the sum of two parts of 33 bits, whose products with n are
/// exact, and a remainder. sin r and cos r are polynomials in r^2, fitted at Chebyshev nodes with an error
/// below 2^-55.
template <class T>
[[gnu::always_inline]] inline void sincos(const T& angle, T& sine, T& cosine) noexcept {
  constexpr double kTwoOverPi = 0.6366197723675814;
  constexpr double kHalfPi1 = 0x1.921fb544p+0;
  constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
  constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
  constexpr double kLimit_rad = 1.0e5;

  const T in_range = detail::select(angle * angle <= T(kLimit_rad * kLimit_rad), angle, T(__builtin_nan("")));
  // 1.5 * 2^52 leaves no fraction bits: the last bits of the sum are the nearest integer.
  constexpr double kShift = 6755399441055744.0;
  const T shifted = in_range * kTwoOverPi + kShift;
  const T n = shifted - kShift;
  const T r = ((in_range - n * kHalfPi1) - n * kHalfPi2) - n * kHalfPi3;
  const T t = r * r;

  const T sine_series =
      -0.16666666666666666 +
      t * (0.008333333333330827 +
           t * (-0.0001984126983657571 +
                t * (2.755731600817155e-06 + t * (-2.5051112272573243e-08 + t * 1.5916726193889336e-10))));
  const T cosine_series =
      0.041666666666666664 +
      t * (-0.0013888888888887322 +
           t * (2.4801587298651292e-05 +
                t * (-2.755731721268659e-07 + t * (2.0876134024090145e-09 + t * -1.1381754653662937e-11))));
  const T sine_r = r + (r * t) * sine_series;
  const T half = 0.5 * t;
  const T leading = 1.0 - half;
  const T cosine_r = leading + (((1.0 - leading) - half) + (t * t) * cosine_series);

  // n mod 4: sine and cosine of r are exchanged when it is odd, and each changes its sign in two quadrants.
  using Integer = typename detail::Bits<T>::type;
  const Integer quadrant = std::bit_cast<Integer>(shifted);
  const Integer sine_bits = std::bit_cast<Integer>(sine_r);
  const Integer cosine_bits = std::bit_cast<Integer>(cosine_r);
  const Integer one = 1;
  const Integer two = 2;
  const Integer exchange = (sine_bits ^ cosine_bits) & (Integer(0) - (quadrant & one));
  sine = std::bit_cast<T>((sine_bits ^ exchange) ^ ((quadrant & two) << 62));
  cosine = std::bit_cast<T>((cosine_bits ^ exchange) ^ (((quadrant + one) & two) << 62));
}

}  // namespace stilt::runtime
