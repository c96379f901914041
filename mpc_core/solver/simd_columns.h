#pragma once

#include <cstring>
#include <type_traits>
#include <utility>

#include "mpc_core/solver/lq_problem.h"

/// Columns of kRows doubles as a few SIMD registers, and the products the Riccati sweep is made of.
///
/// Written with the vector extensions common to GCC and Clang: 8 lanes with AVX-512, 4 with AVX, 2 otherwise.
/// All loops over registers are unrolled at compile time, so that accumulators stay in registers. Real-time
/// safe throughout.
namespace stilt::solver {

#if defined(__AVX512F__)
inline constexpr int kLanes = 8;
inline constexpr int kMaxAccumulators = 18;  ///< registers a product may hold: 32, minus operands
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

/// Sum of the lanes, always in the same order (pairwise).
STILT_INLINE inline double sum(Vec v) noexcept {
  if constexpr (kLanes >= 8) v += shuffle(v, v, Swap<4>{});
  if constexpr (kLanes >= 4) v += shuffle(v, v, Swap<2>{});
  v += shuffle(v, v, Swap<1>{});
  return v[0];
}

/// Scalar product of two columns.
STILT_INLINE inline double dot(const double* a, const double* b) noexcept {
  Vec total = load(a) * load(b);
  unroll<kParts - 1>([&](auto i)
                         STILT_INLINE { total += load(a + (i + 1) * kLanes) * load(b + (i + 1) * kLanes); });
  return sum(total);
}

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

/// Registers at rows kRow ... of a column with the spare rows beyond kStates cleared.
template <int kRow>
STILT_INLINE inline Vec clear_padding(Vec v) noexcept {
  if constexpr (kRow + kLanes > kStates) {
    return shuffle(v, Vec{}, FirstOfX<kStates - kRow>{});
  } else {
    return v;
  }
}

STILT_INLINE inline void transpose(Block& block) noexcept {
  exchange<1>(block);
  if constexpr (kLanes >= 4) exchange<2>(block);
  if constexpr (kLanes >= 8) exchange<4>(block);
}

/// Accumulators of a tile of a product: kColumns columns, kPartCount registers each.
template <int kColumns, int kPartCount>
struct Tile {
  Vec v[kColumns][kPartCount];
};

/// tile += L rows(kFirstPart ...) * [column(0), column(1), ...]: L has kStates columns, column(c) gives the
/// address of the c-th right-hand column (kStates values are read).
template <int kFirstPart, int kColumns, int kPartCount, class Column>
STILT_INLINE inline void add_product(Tile<kColumns, kPartCount>& tile, const double (*left)[kRows],
                                     const Column& column) noexcept {
  for (int k = 0; k < kStates; ++k) {
    Vec l[kPartCount];
    unroll<kPartCount>([&](auto p) STILT_INLINE { l[p] = load(left[k] + (kFirstPart + p) * kLanes); });
    unroll<kColumns>([&](auto c) STILT_INLINE {
      const Vec factor = broadcast(column(c)[k]);
      unroll<kPartCount>([&](auto p) STILT_INLINE { tile.v[c][p] += l[p] * factor; });
    });
  }
}

/// Cuts kColumns columns of kPartCount registers into tiles of equal width that fit the registers and calls
/// body(first, width) with both as integral constants.
template <int kColumns, int kPartCount, class Body>
STILT_INLINE inline void for_each_tile(const Body& body) noexcept {
  constexpr int kWidest = kMaxAccumulators / kPartCount > 0 ? kMaxAccumulators / kPartCount : 1;
  constexpr int kTiles = (kColumns + kWidest - 1) / kWidest;
  constexpr int kWidth = (kColumns + kTiles - 1) / kTiles;
  unroll<kTiles>([&](auto t) STILT_INLINE {
    constexpr int kFirst = t * kWidth;
    constexpr int kCount = kColumns - kFirst < kWidth ? kColumns - kFirst : kWidth;
    body(std::integral_constant<int, kFirst>{}, std::integral_constant<int, kCount>{});
  });
}

/// out(c) = init(c) + L * right(c) for kColumns whole columns; out must not overlap left or right.
template <int kColumns, class Init, class Right, class Out>
STILT_INLINE inline void product(const double (*left)[kRows], const Init& init, const Right& right,
                                 const Out& out) noexcept {
  for_each_tile<kColumns, kParts>([&](auto first, auto width) STILT_INLINE {
    Tile<width, kParts> tile;
    unroll<width>([&](auto c) STILT_INLINE {
      const double* from = init(first + c);
      unroll<kParts>([&](auto p)
                         STILT_INLINE { tile.v[c][p] = from == nullptr ? Vec{} : load(from + p * kLanes); });
    });
    add_product<0>(tile, left, [&](int c) STILT_INLINE { return right(first + c); });
    unroll<width>([&](auto c) STILT_INLINE {
      unroll<kParts>([&](auto p) STILT_INLINE { store(out(first + c) + p * kLanes, tile.v[c][p]); });
    });
  });
}

}  // namespace stilt::solver
