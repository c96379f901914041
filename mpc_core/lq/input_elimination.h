#pragma once

#include "mpc_core/lq/riccati.h"
#include "mpc_core/lq/simd_columns.h"

/// The small dense system of a Riccati stage: H w = -(F x + f_u), solved by H = L D L'. Real-time safe.
namespace stilt::lq {

/// H = R + B'P B (lower triangle) and f_u = r + B'(P b + p).
template <int kInputs>
struct InputTerms {
  double H[kInputs][kInputs];
  double h[kInputs];
};

/// Factorises H = L D L' in place: L below the diagonal, inverse_pivot = 1 / D.
template <int kInputs>
STILT_INLINE inline SweepOutcome factorise(double (&H)[kInputs][kInputs],
                                           double (&inverse_pivot)[kInputs]) noexcept {
  SweepOutcome outcome = SweepOutcome::ok;
  unroll<kInputs>([&](auto j) STILT_INLINE {
    const double diagonal = H[j][j];
    double pivot = diagonal;
    double scaled[kInputs];  // L(j, :) D
    unroll<j>([&](auto m) STILT_INLINE {
      scaled[m] = H[j][m];
      H[j][m] *= inverse_pivot[m];
      pivot -= scaled[m] * H[j][m];
    });
    if (outcome == SweepOutcome::ok && !(pivot > kSmallestRelativePivot * diagonal && diagonal > 0.0)) {
      outcome = SweepOutcome::not_positive_definite;
    }
    if (!__builtin_isfinite(pivot)) outcome = SweepOutcome::not_finite;
    inverse_pivot[j] = 1.0 / pivot;
    unroll<kInputs - 1 - j>([&](auto below) STILT_INLINE {
      constexpr int i = j + 1 + below;
      unroll<j>([&](auto m) STILT_INLINE { H[i][j] -= H[i][m] * H[j][m]; });
    });
  });
  return outcome;
}

/// Computes the gains K and, part by part, the two factors y = L^-1 F and z = -D^-1 y of -F'H^-1 F = y'z.
template <int kInputs>
STILT_INLINE inline void solve_gains(const InputTerms<kInputs>& terms, const double (&inverse_pivot)[kInputs],
                                     RiccatiWorkspace& work, LqGain& gain) noexcept {
  const auto& L = terms.H;
  unroll<kParts>([&](auto part) STILT_INLINE {
    constexpr int kLane = part * kLanes;
    Vec y[kInputs], z[kInputs];
    unroll<kInputs>([&](auto i) STILT_INLINE {
      y[i] = load(work.F[i] + kLane);
      unroll<i>([&](auto j) STILT_INLINE { y[i] -= L[i][j] * y[j]; });
      z[i] = y[i] * -inverse_pivot[i];
      store(work.y[i] + kLane, y[i]);
      store(work.half_y[i] + kLane, y[i] * broadcast(0.5));
      store(work.z[i] + kLane, z[i]);
    });
    unroll<kInputs>([&](auto from_last) STILT_INLINE {
      constexpr int i = kInputs - 1 - from_last;
      unroll<from_last>([&](auto above) STILT_INLINE { z[i] -= L[i + 1 + above][i] * z[i + 1 + above]; });
      store(gain.K[i] + kLane, z[i]);
    });
    unroll<kMaxFreeInputs - kInputs>([&](auto i) STILT_INLINE { store(gain.K[kInputs + i] + kLane, Vec{}); });
  });
}

/// Computes the feed-forward k of the gain, and z = -D^-1 L^-1 f_u.
template <int kInputs>
STILT_INLINE inline void solve_feedforward(const InputTerms<kInputs>& terms,
                                           const double (&inverse_pivot)[kInputs], LqGain& gain,
                                           double (&z)[kInputs]) noexcept {
  const auto& L = terms.H;
  double y[kInputs];
  unroll<kInputs>([&](auto i) STILT_INLINE {
    y[i] = terms.h[i];
    unroll<i>([&](auto j) STILT_INLINE { y[i] -= L[i][j] * y[j]; });
    z[i] = y[i] * -inverse_pivot[i];
  });
  unroll<kInputs>([&](auto from_last) STILT_INLINE {
    constexpr int i = kInputs - 1 - from_last;
    gain.k[i] = z[i];
    unroll<from_last>([&](auto above)
                          STILT_INLINE { gain.k[i] -= L[i + 1 + above][i] * gain.k[i + 1 + above]; });
  });
}

}  // namespace stilt::lq
