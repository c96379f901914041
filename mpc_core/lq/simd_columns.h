#pragma once

#include <cstring>
#include <type_traits>
#include <utility>

#include "mpc_core/lq/lq_problem.h"

/// Columns of kRows doubles as a few SIMD registers, with the operations of the Riccati sweep.
///
/// Uses the vector extensions common to GCC and Clang: 8 lanes with AVX-512, 4 with AVX, 2 otherwise. All
/// loops over registers are unrolled at compile time, so that accumulators stay in registers. Real-time safe.
namespace stilt::lq {

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
inline constexpr int kParts = kRows / kLanes;  ///< registers per column

typedef double Vec __attribute__((vector_size(kLanes * sizeof(double))));

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define STILT_INLINE  // with instrumentation, fully inlined kernels would take minutes to compile
#else
#define STILT_INLINE __attribute__((always_inline))
#endif

/// Calls f(integral_constant<int, 0>) ... f(integral_constant<int, N - 1>).
template <int N, class F>
STILT_INLINE inline void unroll(const F& f) noexcept {
  [&]<int... I>(std::integer_sequence<int, I...>)
      STILT_INLINE { (f(std::integral_constant<int, I>{}), ...); }(std::make_integer_sequence<int, N>{});
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
  }(std::make_integer_sequence<int, kLanes>{});
}

/// Lane selectors for shuffle().
template <int kDistance>
struct Swap {  ///< exchanges lanes at a distance
  static constexpr int at(int l) noexcept { return l ^ kDistance; }
};
template <int kDistance>
struct LowHalves {  ///< of x and y: the lower of every pair of groups of kDistance lanes
  static constexpr int at(int l) noexcept { return (l & kDistance) == 0 ? l : l - kDistance + kLanes; }
};
template <int kDistance>
struct HighHalves {  ///< of x and y: the upper of every pair of groups of kDistance lanes
  static constexpr int at(int l) noexcept { return (l & kDistance) == 0 ? l + kDistance : l + kLanes; }
};
template <int kCount>
struct FirstOfX {  ///< the first kCount lanes of x, the other lanes of y
  static constexpr int at(int l) noexcept { return l < kCount ? l : l + kLanes; }
};
template <int kFirst, int kEnd>
struct LanesBetween {  ///< lanes kFirst ... kEnd - 1 of x, the other lanes of y
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

/// Lane-by-lane product of two columns, summed over the registers. The sum of its lanes is the scalar
/// product.
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

/// One step of a transposition. In every pair of columns c and c + kDistance, exchanges the halves on the
/// wrong side of the diagonal of their 2 kDistance square.
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

/// The free motion E = [I  h I; 0  I] moves entries by kHalf rows, one less than a whole number of registers.
inline constexpr int kHalf = kStates / 2;
static_assert((kHalf + 1) % kLanes == 0 && kStates == 2 * kHalf);

/// Whether register `part` of a column holds any of the rows kHalf ... kStates - 1, or 0 ... kHalf - 1.
[[nodiscard]] constexpr bool has_velocity(int part) noexcept { return (part + 1) * kLanes > kHalf; }
[[nodiscard]] constexpr bool has_position(int part) noexcept { return part * kLanes < kHalf; }

/// h in the rows of the velocities or of the positions, zero elsewhere.
struct FreeMotion {
  Vec velocity[kParts];
  Vec position[kParts];

  STILT_INLINE explicit FreeMotion(double h) noexcept {
    unroll<kParts>([&](auto part) STILT_INLINE {
      constexpr int kRow = part * kLanes;
      position[part] = shuffle(broadcast(h), Vec{}, LanesBetween<-kRow, kHalf - kRow>{});
      velocity[part] = shuffle(broadcast(h), Vec{}, LanesBetween<kHalf - kRow, kStates - kRow>{});
    });
  }
};

/// Register kPart of v moved down by kHalf rows. Only the lanes of rows kHalf ... kStates - 1 are valid; the
/// others hold some other entry of v.
template <int kPart>
STILT_INLINE inline Vec shifted_down(const double* v) noexcept {
  if constexpr ((kPart + 1) * kLanes == kHalf + 1) {
    return broadcast(v[0]);
  } else if constexpr (has_velocity(kPart)) {
    return load(v + kPart * kLanes - kHalf);
  } else {
    return Vec{};
  }
}

/// Register kPart of E'v: adds h v_q to the velocities.
template <int kPart>
STILT_INLINE inline Vec free_motion_transposed(const double* v, const FreeMotion& motion) noexcept {
  const Vec out = load(v + kPart * kLanes);
  return has_velocity(kPart) ? out + shifted_down<kPart>(v) * motion.velocity[kPart] : out;
}

/// The lanes above kLane unchanged, half of lane kLane, zero below. A block of such columns plus its
/// transpose is the symmetric block with the same lower triangle.
template <int kLane>
STILT_INLINE inline Vec lower_half(Vec v) noexcept {
  const Vec lower = shuffle(v, Vec{}, LanesBetween<kLane, kLanes>{});
  return lower * shuffle(broadcast(0.5), broadcast(1.0), FirstOfX<kLane + 1>{});
}

/// Register kPart of E v: adds h v_v to the positions.
template <int kPart>
STILT_INLINE inline Vec free_motion(const double* v, const FreeMotion& motion) noexcept {
  Vec out = load(v + kPart * kLanes);
  if constexpr (has_position(kPart)) {
    const double* shifted = v + kPart * kLanes + kHalf + 1 - kLanes;
    out += shuffle(load(shifted), load(shifted + kLanes), Window<kLanes - 1>{}) * motion.position[kPart];
  }
  return out;
}

/// Prevents the compiler from keeping stored values in registers, which it would have to spill. Loading them
/// again costs less.
STILT_INLINE inline void reload_values() noexcept { asm volatile("" ::: "memory"); }

/// Prevents the compiler from loading v again at each use.
STILT_INLINE inline Vec in_register(Vec v) noexcept {
#if defined(__AVX__)
  asm("" : "+v"(v));
#endif
  return v;
}

/// Accumulators: columns kFirst ... kFirst + kCount - 1 of a product.
template <int kFirst, int kCount>
struct Tile {
  Vec v[kCount][kParts];

  /// Calls body(c, part) for all registers, with integral constants; column c of the tile is kFirst + c.
  template <class Body>
  STILT_INLINE static void for_each(const Body& body) noexcept {
    unroll<kCount>([&](auto c)
                       STILT_INLINE { unroll<kParts>([&](auto part) STILT_INLINE { body(c, part); }); });
  }

  /// Adds left * factor(c) to the columns c of the tile from kFrom on.
  template <int kFrom = 0, class Factor>
  STILT_INLINE void add(const double* left, const Factor& factor) noexcept {
    add_registers<kFrom>([&](auto p) STILT_INLINE { return load(left + p * kLanes); }, factor);
  }
  /// The same with register p of the left side from left(p).
  template <int kFrom = 0, class Left, class Factor>
  STILT_INLINE void add_registers(const Left& left, const Factor& factor) noexcept {
    if constexpr (kFrom < kCount) {
      Vec f[kCount];
      unroll<kCount - kFrom>([&](auto i) STILT_INLINE {
        f[kFrom + i] = broadcast(factor(std::integral_constant<int, kFrom + i>{}));
      });
      unroll<kParts>([&](auto p) STILT_INLINE {
        const Vec l = in_register(left(p));
        unroll<kCount - kFrom>([&](auto i) STILT_INLINE { v[kFrom + i][p] += l * f[kFrom + i]; });
      });
    }
  }
};

/// Splits columns kFirst ... kEnd - 1 into tiles that fit the registers and calls body(tile) for each.
template <int kFirst, int kEnd, class Body>
STILT_INLINE inline void for_each_tile(const Body& body) noexcept {
  if constexpr (kFirst < kEnd) {
    constexpr int kFit = kMaxAccumulators / kParts > 0 ? kMaxAccumulators / kParts : 1;
    constexpr int kCount = kEnd - kFirst < kFit ? kEnd - kFirst : kFit;
    Tile<kFirst, kCount> tile;
    body(tile);
    reload_values();
    for_each_tile<kFirst + kCount, kEnd>(body);
  }
}

/// Square block at register kPart of columns kColumn ... of a matrix of kStates columns.
template <int kColumn, int kPart>
STILT_INLINE inline Block load_block(const double (*P)[kRows]) noexcept {
  Block block{};
  unroll<kLanes>([&](auto c) STILT_INLINE {
    if constexpr (kColumn + c < kStates) block.column[c] = load(P[kColumn + c] + kPart * kLanes);
  });
  return block;
}

/// Stores x + y as the block at register kPart of columns kColumn ...
template <int kColumn, int kPart>
STILT_INLINE inline void store_sum(double (*P)[kRows], const Block& x, const Block& y) noexcept {
  unroll<kLanes>([&](auto c) STILT_INLINE {
    if constexpr (kColumn + c < kStates) store(P[kColumn + c] + kPart * kLanes, x.column[c] + y.column[c]);
  });
}

/// P = N + N' in place, exactly symmetric.
STILT_INLINE inline void add_transpose(double (*P)[kRows]) noexcept {
  unroll<kParts>([&](auto left) STILT_INLINE {
    unroll<kParts - left>([&](auto distance) STILT_INLINE {
      constexpr int kLow = left + distance;
      const Block below = load_block<left * kLanes, kLow>(P);
      Block below_transposed = below;
      transpose(below_transposed);
      if constexpr (distance == 0) {
        store_sum<left * kLanes, left>(P, below, below_transposed);
      } else {
        const Block above = load_block<kLow * kLanes, left>(P);
        Block above_transposed = above;
        transpose(above_transposed);
        store_sum<left * kLanes, kLow>(P, below, above_transposed);
        store_sum<kLow * kLanes, left>(P, above, below_transposed);
      }
      reload_values();
    });
  });
}

}  // namespace stilt::lq
