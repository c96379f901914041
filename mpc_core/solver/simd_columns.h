#pragma once

#include <cstring>
#include <type_traits>
#include <utility>

#include "mpc_core/solver/lq_problem.h"

/// Columns of kRows doubles as a few SIMD registers, and the operations the Riccati sweep is made of.
///
/// Written with the vector extensions common to GCC and Clang: 8 lanes with AVX-512, 4 with AVX, 2 otherwise.
/// All loops over registers are unrolled at compile time, so that accumulators stay in registers. Real-time
/// safe throughout.
namespace stilt::solver {

#if defined(__AVX512F__)
inline constexpr int kLanes = 8;
inline constexpr int kMaxAccumulators = 22;  ///< registers a product may hold: 32, minus operands
#elif defined(__AVX__)
inline constexpr int kLanes = 4;
inline constexpr int kMaxAccumulators = 12;  ///< 16, minus operands
#else
inline constexpr int kLanes = 2;
inline constexpr int kMaxAccumulators = 12;
#endif
inline constexpr int kParts = kRows / kLanes;  ///< registers a column

typedef double Vec __attribute__((vector_size(kLanes * sizeof(double))));

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define STILT_INLINE  // instrumented kernels of one piece would take minutes to compile
#else
#define STILT_INLINE __attribute__((always_inline))
#endif

/// Calls f(integral_constant<int, 0>) ... f(integral_constant<int, N - 1>).
template <int N, class F>
STILT_INLINE inline void unroll(const F& f) noexcept {
  [&]<int... I>(std::integer_sequence<int, I...>) STILT_INLINE { (f(std::integral_constant<int, I>{}), ...); }
  (std::make_integer_sequence<int, N>{});
}

STILT_INLINE inline Vec load(const double* from) noexcept {
  Vec v;
  std::memcpy(&v, from, sizeof(v));
  return v;
}
STILT_INLINE inline void store(double* to, Vec v) noexcept { std::memcpy(to, &v, sizeof(v)); }
STILT_INLINE inline Vec broadcast(double value) noexcept { return value - Vec{}; }

/// Lane l of the result is lane Source::at(l) of [x, y]; y's lanes start at kLanes.
template <class Source>
STILT_INLINE inline Vec shuffle(Vec x, Vec y, Source) noexcept {
  return [&]<int... L>(std::integer_sequence<int, L...>) STILT_INLINE {
    return __builtin_shufflevector(x, y, std::integral_constant<int, Source::at(L)>::value...);
  }
  (std::make_integer_sequence<int, kLanes>{});
}

/// Lane selectors for shuffle().
template <int kDistance>
struct Swap {  ///< exchanges lanes at a distance
  static constexpr int at(int l) noexcept { return l ^ kDistance; }
};
template <int kDistance>
struct LowHalves {  ///< of x and y, of every pair of groups of kDistance lanes the lower
  static constexpr int at(int l) noexcept { return (l & kDistance) == 0 ? l : l - kDistance + kLanes; }
};
template <int kDistance>
struct HighHalves {  ///< the same, the upper
  static constexpr int at(int l) noexcept { return (l & kDistance) == 0 ? l + kDistance : l + kLanes; }
};
template <int kCount>
struct FirstOfX {  ///< the first kCount lanes of x, the others of y
  static constexpr int at(int l) noexcept { return l < kCount ? l : l + kLanes; }
};
template <int kFirst, int kEnd>
struct LanesBetween {  ///< lanes kFirst ... kEnd - 1 of x, the others of y
  static constexpr int at(int l) noexcept { return l >= kFirst && l < kEnd ? l : l + kLanes; }
};
template <int kFirst>
struct Window {  ///< kLanes lanes of [x, y] from lane kFirst
  static constexpr int at(int l) noexcept { return l + kFirst; }
};

/// Sum of the lanes, always in the same order (pairwise).
STILT_INLINE inline double sum(Vec v) noexcept {
  if constexpr (kLanes >= 8) v += shuffle(v, v, Swap<4>{});
  if constexpr (kLanes >= 4) v += shuffle(v, v, Swap<2>{});
  v += shuffle(v, v, Swap<1>{});
  return v[0];
}

/// Lane by lane product of two columns, summed over the registers: its lanes add up to the scalar product.
STILT_INLINE inline Vec lanes_of_dot(const double* a, const double* b) noexcept {
  Vec total = load(a) * load(b);
  unroll<kParts - 1>([&](auto i)
                         STILT_INLINE { total += load(a + (i + 1) * kLanes) * load(b + (i + 1) * kLanes); });
  return total;
}

/// Scalar product of two columns.
STILT_INLINE inline double dot(const double* a, const double* b) noexcept { return sum(lanes_of_dot(a, b)); }

/// Square block of kLanes columns, one register each.
struct Block {
  Vec column[kLanes];
};

/// One step of a transposition: exchanges, within every pair of columns c and c + kDistance, the halves that
/// lie on the wrong side of the diagonal of their 2 kDistance square.
template <int kDistance>
STILT_INLINE inline void exchange(Block& block) noexcept {
  unroll<kLanes>([&](auto c) STILT_INLINE {
    if constexpr ((c & kDistance) == 0) {
      const Vec x = block.column[c], y = block.column[c + kDistance];
      block.column[c] = shuffle(x, y, LowHalves<kDistance>{});
      block.column[c + kDistance] = shuffle(x, y, HighHalves<kDistance>{});
    }
  });
}

STILT_INLINE inline void transpose(Block& block) noexcept {
  exchange<1>(block);
  if constexpr (kLanes >= 4) exchange<2>(block);
  if constexpr (kLanes >= 8) exchange<4>(block);
}

/// Lane l of the result is the sum of the lanes of column l: the horizontal sums share their shuffles.
STILT_INLINE inline Vec column_sums(Block& block) noexcept {
  const auto halve = [&]<int kDistance>(std::integral_constant<int, kDistance>) STILT_INLINE {
    unroll<kLanes / (2 * kDistance)>([&](auto i) STILT_INLINE {
      const Vec x = block.column[2 * i], y = block.column[2 * i + 1];
      block.column[i] = shuffle(x, y, LowHalves<kDistance>{}) + shuffle(x, y, HighHalves<kDistance>{});
    });
  };
  halve(std::integral_constant<int, 1>{});
  if constexpr (kLanes >= 4) halve(std::integral_constant<int, 2>{});
  if constexpr (kLanes >= 8) halve(std::integral_constant<int, 4>{});
  return block.column[0];
}

/// Registers at rows kRow ... of a column with the spare rows beyond kStates cleared.
template <int kRow>
STILT_INLINE inline Vec clear_padding(Vec v) noexcept {
  if constexpr (kRow + kLanes > kStates) {
    return shuffle(v, Vec{}, FirstOfX<kStates - kRow>{});
  } else {
    return v;
  }
}

/// The free motion E = [I  h I; 0  I] moves by kHalf rows, one less than a whole number of registers.
inline constexpr int kHalf = kStates / 2;
static_assert((kHalf + 1) % kLanes == 0 && kStates == 2 * kHalf);

/// Whether register `part` of a column holds any of the rows kHalf ... kStates - 1, or 0 ... kHalf - 1.
[[nodiscard]] constexpr bool has_velocity(int part) noexcept { return (part + 1) * kLanes > kHalf; }
[[nodiscard]] constexpr bool has_position(int part) noexcept { return part * kLanes < kHalf; }

/// h in the rows of the velocities, or of the positions, zero elsewhere.
struct Drift {
  Vec velocity[kParts];
  Vec position[kParts];

  STILT_INLINE explicit Drift(double h) noexcept {
    unroll<kParts>([&](auto part) STILT_INLINE {
      constexpr int kRow = part * kLanes;
      position[part] = shuffle(broadcast(h), Vec{}, LanesBetween<-kRow, kHalf - kRow>{});
      velocity[part] = shuffle(broadcast(h), Vec{}, LanesBetween<kHalf - kRow, kStates - kRow>{});
    });
  }
};

/// Register kPart of E'v: v_q is added to the velocities, times h.
template <int kPart>
STILT_INLINE inline Vec free_motion_transposed(const double* v, const Drift& drift) noexcept {
  Vec out = load(v + kPart * kLanes);
  if constexpr ((kPart + 1) * kLanes == kHalf + 1) {
    out += broadcast(v[0]) * drift.velocity[kPart];
  } else if constexpr (has_velocity(kPart)) {
    const double* shifted = v + kPart * kLanes - kHalf - 1;
    out += shuffle(load(shifted), load(shifted + kLanes), Window<1>{}) * drift.velocity[kPart];
  }
  return out;
}

/// Register kPart of E v: v_v is added to the positions, times h.
template <int kPart>
STILT_INLINE inline Vec free_motion(const double* v, const Drift& drift) noexcept {
  Vec out = load(v + kPart * kLanes);
  if constexpr (has_position(kPart)) {
    const double* shifted = v + kPart * kLanes + kHalf + 1 - kLanes;
    out += shuffle(load(shifted), load(shifted + kLanes), Window<kLanes - 1>{}) * drift.position[kPart];
  }
  return out;
}

/// Accumulators: columns kFirst ... kFirst + kCount - 1 of a symmetric matrix, each from the register that
/// holds its diagonal on, or (kWhole) whole.
template <int kFirst, int kCount, bool kWhole>
struct Tile {
  Vec v[kCount][kParts];

  [[nodiscard]] static constexpr int first_part(int c) noexcept { return kWhole ? 0 : (kFirst + c) / kLanes; }

  /// body(c, part) for all registers, both integral constants; column c of the tile is kFirst + c.
  template <class Body>
  STILT_INLINE static void for_each(const Body& body) noexcept {
    unroll<kCount>([&](auto c) STILT_INLINE {
      unroll<kParts - first_part(c)>(
          [&](auto p) STILT_INLINE { body(c, std::integral_constant<int, first_part(c) + p>{}); });
    });
  }

  /// Adds left * factor(c) to column c.
  template <class Factor>
  STILT_INLINE void add(const double* left, const Factor& factor) noexcept {
    Vec l[kParts];
    unroll<kParts - first_part(0)>(
        [&](auto p) STILT_INLINE { l[first_part(0) + p] = load(left + (first_part(0) + p) * kLanes); });
    unroll<kCount>([&](auto c) STILT_INLINE {
      const Vec f = broadcast(factor(c));
      unroll<kParts - first_part(c)>(
          [&](auto p) STILT_INLINE { v[c][first_part(c) + p] += l[first_part(c) + p] * f; });
    });
  }
};

/// Number of columns from `first` on, up to `end`, whose accumulators fit the registers.
template <bool kWhole>
[[nodiscard]] constexpr int tile_width(int first, int end) noexcept {
  int width = 0, accumulators = 0;
  while (first + width < end) {
    accumulators += kWhole ? kParts : kParts - (first + width) / kLanes;
    if (width > 0 && accumulators > kMaxAccumulators) break;
    ++width;
  }
  return width;
}

/// Cuts columns kFirst ... kEnd - 1 into tiles that fit the registers and calls body(tile) for each.
template <bool kWhole, int kFirst, int kEnd, class Body>
STILT_INLINE inline void for_each_tile(const Body& body) noexcept {
  if constexpr (kFirst < kEnd) {
    constexpr int kCount = tile_width<kWhole>(kFirst, kEnd);
    Tile<kFirst, kCount, kWhole> tile;
    body(tile);
    for_each_tile<kWhole, kFirst + kCount, kEnd>(body);
  }
}

}  // namespace stilt::solver
