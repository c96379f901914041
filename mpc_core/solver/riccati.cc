#include "mpc_core/solver/riccati.h"

#include "mpc_core/solver/simd_columns.h"

namespace stilt::solver {
namespace {

constexpr int kPadding = kRows - kStates;  ///< spare lanes of a column; two of B's columns ride in them

/// rows of [A, B_0, B_1] as columns: transposed[k] = [A(k, 0..13), B(k, 0), B(k, 1)].
template <int kInputs>
STILT_INLINE inline void transpose_dynamics(const LqStage& stage, double (*transposed)[kRows]) noexcept {
  unroll<kParts>([&](auto row_part) STILT_INLINE {
    unroll<kParts>([&](auto column_part) STILT_INLINE {
      Block block;
      unroll<kLanes>([&](auto c) STILT_INLINE {
        constexpr int kColumn = column_part * kLanes + c;
        constexpr int kInput = kColumn - kStates;
        if constexpr (kColumn < kStates) {
          block.column[c] = load(stage.A[kColumn] + row_part * kLanes);
        } else if constexpr (kInput < kInputs) {
          block.column[c] = load(stage.B[kInput] + row_part * kLanes);
        } else {
          block.column[c] = Vec{};
        }
      });
      transpose(block);
      unroll<kLanes>([&](auto r) STILT_INLINE {
        constexpr int kRow = row_part * kLanes + r;
        if constexpr (kRow < kStates) store(transposed[kRow] + column_part * kLanes, block.column[r]);
      });
    });
  });
}

/// R + B'P B (lower triangle) and r + B'(P b + p).
template <int kInputs>
struct InputTerms {
  double H[kInputs][kInputs];
  double h[kInputs];
};

/// Products with B_0 and B_1 are already in the spare lanes of G; those with B_2 and B_3 are formed here.
template <int kInputs>
STILT_INLINE inline InputTerms<kInputs> input_terms(const LqStage& stage,
                                                    const RiccatiWorkspace& work) noexcept {
  InputTerms<kInputs> terms;
  unroll<kInputs>([&](auto i) STILT_INLINE {
    unroll<i + 1>([&](auto j) STILT_INLINE {
      if constexpr (j < kPadding) {
        terms.H[i][j] = stage.R[j][i] + work.G[i][kStates + j];
      } else {
        terms.H[i][j] = stage.R[j][i] + dot(stage.B[j], work.PB[i]);
      }
    });
    if constexpr (i < kPadding) {
      terms.h[i] = stage.r[i] + work.G[kInputs][kStates + i];
    } else {
      terms.h[i] = stage.r[i] + dot(stage.B[i], work.PB[kInputs]);
    }
  });
  return terms;
}

/// H = L D L' in place: L below the diagonal; inverse_pivot = 1 / D.
template <int kInputs>
STILT_INLINE inline SweepOutcome factorise(double (&H)[kInputs][kInputs],
                                           double (&inverse_pivot)[kInputs]) noexcept {
  SweepOutcome outcome = SweepOutcome::kOk;
  unroll<kInputs>([&](auto j) STILT_INLINE {
    const double diagonal = H[j][j];
    double pivot = diagonal;
    double scaled[kInputs];  // L(j, :) D
    unroll<j>([&](auto m) STILT_INLINE {
      scaled[m] = H[j][m];
      H[j][m] *= inverse_pivot[m];
      pivot -= scaled[m] * H[j][m];
    });
    if (outcome == SweepOutcome::kOk && !(pivot > kSmallestRelativePivot * diagonal && diagonal > 0.0)) {
      outcome = SweepOutcome::kNotPositiveDefinite;
    }
    if (!__builtin_isfinite(pivot)) outcome = SweepOutcome::kNotFinite;
    inverse_pivot[j] = 1.0 / pivot;
    unroll<kInputs - 1 - j>([&](auto below) STILT_INLINE {
      constexpr int i = j + 1 + below;
      unroll<j>([&](auto m) STILT_INLINE { H[i][j] -= H[i][m] * H[j][m]; });
    });
  });
  return outcome;
}

/// Gains and the two factors y, z of -G'H^-1 G = y'z, part by part; spare lanes come out zero.
template <int kInputs>
STILT_INLINE inline void solve_gains(const InputTerms<kInputs>& terms, const double (&inverse_pivot)[kInputs],
                                     RiccatiWorkspace& work, LqGain& gain) noexcept {
  const auto& L = terms.H;
  unroll<kParts>([&](auto part) STILT_INLINE {
    constexpr int kLane = part * kLanes;
    Vec y[kInputs], z[kInputs];
    unroll<kInputs>([&](auto i) STILT_INLINE {
      y[i] = clear_padding<kLane>(load(work.G[i] + kLane));
      unroll<i>([&](auto j) STILT_INLINE { y[i] -= L[i][j] * y[j]; });
      z[i] = y[i] * -inverse_pivot[i];
      store(work.y[i] + kLane, y[i]);
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

/// Feed-forward part of the gain; returns in y the solution of L y = h_u.
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

/// Lower triangle, by whole registers, of P = Q + A'(P A) + y'z.
template <int kInputs>
STILT_INLINE inline void update_hessian(const LqStage& stage, const RiccatiWorkspace& work,
                                        double (*P)[kRows]) noexcept {
  unroll<kParts>([&](auto group) STILT_INLINE {
    constexpr int kFirstColumn = group * kLanes;
    constexpr int kColumns = kStates - kFirstColumn < kLanes ? kStates - kFirstColumn : kLanes;
    constexpr int kPartCount = kParts - group;
    if constexpr (kColumns > 0) {
      for_each_tile<kColumns, kPartCount>([&](auto first, auto width) STILT_INLINE {
        constexpr int kColumn = kFirstColumn + first;
        Tile<width, kPartCount> tile;
        unroll<width>([&](auto c) STILT_INLINE {
          unroll<kPartCount>(
              [&](auto p) STILT_INLINE { tile.v[c][p] = load(stage.Q[kColumn + c] + (group + p) * kLanes); });
        });
        add_product<group>(tile, work.transposed, [&](int c) STILT_INLINE { return work.PA[kColumn + c]; });
        unroll<kInputs>([&](auto i) STILT_INLINE {
          unroll<width>([&](auto c) STILT_INLINE {
            const Vec factor = broadcast(work.z[i][kColumn + c]);
            unroll<kPartCount>([&](auto p) STILT_INLINE {
              tile.v[c][p] += load(work.y[i] + (group + p) * kLanes) * factor;
            });
          });
        });
        unroll<width>([&](auto c) STILT_INLINE {
          unroll<kPartCount>(
              [&](auto p) STILT_INLINE { store(P[kColumn + c] + (group + p) * kLanes, tile.v[c][p]); });
        });
      });
    }
  });
}

/// Copies the lower triangle of P to the upper and clears the padding.
STILT_INLINE inline void mirror(double (*P)[kRows]) noexcept {
  unroll<kParts>([&](auto column_part) STILT_INLINE {
    unroll<kParts>([&](auto row_part) STILT_INLINE {
      constexpr int kColumn = column_part * kLanes, kRow = row_part * kLanes;
      if constexpr (row_part >= column_part && kColumn < kStates) {
        Block block;
        unroll<kLanes>([&](auto c) STILT_INLINE {
          if constexpr (kColumn + c < kStates) {
            block.column[c] = clear_padding<kRow>(load(P[kColumn + c] + kRow));
          } else {
            block.column[c] = Vec{};
          }
        });
        Block other = block;
        transpose(other);
        unroll<kLanes>([&](auto c) STILT_INLINE {
          if constexpr (row_part == column_part) {
            const Vec both = shuffle(other.column[c], block.column[c], FirstOfX<c>{});
            if constexpr (kColumn + c < kStates) store(P[kColumn + c] + kRow, both);
          } else {
            if constexpr (kRow + kLanes > kStates && kColumn + c < kStates) {
              store(P[kColumn + c] + kRow, block.column[c]);
            }
            if constexpr (kRow + c < kStates) store(P[kRow + c] + kColumn, other.column[c]);
          }
        });
      }
    });
  });
}

/// p = h_x + sum_i y_i z_i.
template <int kInputs>
STILT_INLINE inline void update_gradient(const RiccatiWorkspace& work, const double* z, double* p) noexcept {
  unroll<kParts>([&](auto part) STILT_INLINE {
    Vec v = load(work.G[kInputs] + part * kLanes);
    unroll<kInputs>([&](auto i) STILT_INLINE { v += load(work.y[i] + part * kLanes) * broadcast(z[i]); });
    store(p + part * kLanes, clear_padding<part * kLanes>(v));
  });
}

/// One stage of the backward sweep.
template <int kInputs>
[[gnu::noinline]] SweepOutcome sweep_stage(const LqStage& stage, const ValueFunction& next,
                                           ValueFunction& value, LqGain& gain,
                                           RiccatiWorkspace& work) noexcept {
  transpose_dynamics<kInputs>(stage, work.transposed);
  product<kInputs + 1>(
      next.P, [&](int c) STILT_INLINE { return c == kInputs ? next.p : nullptr; },
      [&](int c) STILT_INLINE { return c == kInputs ? stage.b : stage.B[c]; },
      [&](int c) STILT_INLINE { return work.PB[c]; });
  product<kInputs + 1>(
      work.transposed, [&](int c) STILT_INLINE { return c == kInputs ? stage.q : stage.S[c]; },
      [&](int c) STILT_INLINE { return work.PB[c]; }, [&](int c) STILT_INLINE { return work.G[c]; });

  SweepOutcome outcome = SweepOutcome::kOk;
  double z[kInputs > 0 ? kInputs : 1];
  if constexpr (kInputs > 0) {
    InputTerms<kInputs> terms = input_terms<kInputs>(stage, work);
    double inverse_pivot[kInputs];
    outcome = factorise<kInputs>(terms.H, inverse_pivot);
    solve_gains<kInputs>(terms, inverse_pivot, work, gain);
    solve_feedforward<kInputs>(terms, inverse_pivot, gain, z);
  } else {
    std::memset(gain.K, 0, sizeof(gain.K));
  }
  unroll<kMaxFreeInputs - kInputs>([&](auto i) STILT_INLINE { gain.k[kInputs + i] = 0.0; });

  product<kStates>(
      next.P, [](int) STILT_INLINE -> const double* { return nullptr; },
      [&](int c) STILT_INLINE { return stage.A[c]; }, [&](int c) STILT_INLINE { return work.PA[c]; });
  update_hessian<kInputs>(stage, work, value.P);
  mirror(value.P);
  update_gradient<kInputs>(work, z, value.p);
  return outcome;
}

SweepOutcome sweep_any_stage(const LqStage& stage, const ValueFunction& next, ValueFunction& value,
                             LqGain& gain, RiccatiWorkspace& work) noexcept {
  switch (stage.free_inputs) {
    case 0:
      return sweep_stage<0>(stage, next, value, gain, work);
    case 1:
      return sweep_stage<1>(stage, next, value, gain, work);
    case 2:
      return sweep_stage<2>(stage, next, value, gain, work);
    case 3:
      return sweep_stage<3>(stage, next, value, gain, work);
    case 4:
      return sweep_stage<4>(stage, next, value, gain, work);
    default:
      return SweepOutcome::kBadInputCount;
  }
}

/// True when every entry is finite: 0 * v is zero then, and NaN otherwise.
bool is_finite(const ValueFunction& value) noexcept {
  Vec zero{};
  for (const auto& column : value.P) {
    unroll<kParts>([&](auto part) STILT_INLINE { zero += load(column + part * kLanes) * broadcast(0.0); });
  }
  unroll<kParts>([&](auto part) STILT_INLINE { zero += load(value.p + part * kLanes) * broadcast(0.0); });
  return sum(zero) == 0.0;
}

/// steps[1].x and steps[0].w from steps[0].x.
template <int kInputs>
STILT_INLINE inline void roll_stage(const LqStage& stage, const LqGain& gain, LqStep* steps) noexcept {
  const double* x = steps[0].x;
  double* w = steps[0].w;
  unroll<kInputs>([&](auto i) STILT_INLINE { w[i] = gain.k[i] + dot(gain.K[i], x); });
  unroll<kMaxFreeInputs - kInputs>([&](auto i) STILT_INLINE { w[kInputs + i] = 0.0; });
  unroll<kParts>([&](auto part) STILT_INLINE {
    constexpr int kLane = part * kLanes;
    Vec even = load(stage.b + kLane), odd{};
    unroll<kStates / 2>([&](auto j) STILT_INLINE {
      even += load(stage.A[2 * j] + kLane) * broadcast(x[2 * j]);
      odd += load(stage.A[2 * j + 1] + kLane) * broadcast(x[2 * j + 1]);
    });
    even += odd;
    unroll<kInputs>([&](auto i) STILT_INLINE { even += load(stage.B[i] + kLane) * broadcast(w[i]); });
    store(steps[1].x + kLane, even);
  });
}

}  // namespace

SweepStatus backward_sweep(const LqStage* stages, int count, const LqTerminal& terminal, LqGain* gains,
                           RiccatiWorkspace& workspace, ValueFunction* values) noexcept {
  ValueFunction* next = &workspace.value[0];
  std::memcpy(next->P, terminal.Q, sizeof(next->P));
  mirror(next->P);
  std::memcpy(next->p, terminal.q, sizeof(next->p));
  if (values != nullptr) values[count] = *next;
  for (int k = count - 1; k >= 0; --k) {
    ValueFunction* value = &workspace.value[(count - k) & 1];
    const SweepOutcome outcome = sweep_any_stage(stages[k], *next, *value, gains[k], workspace);
    if (outcome != SweepOutcome::kOk) return {outcome, k};
    if (values != nullptr) values[k] = *value;
    next = value;
  }
  if (!is_finite(*next)) return {SweepOutcome::kNotFinite, 0};
  return {};
}

void forward_sweep(const LqStage* stages, int count, const LqGain* gains, const double* x0,
                   LqStep* steps) noexcept {
  std::memcpy(steps[0].x, x0, sizeof(steps[0].x));
  for (int k = 0; k < count; ++k) {
    switch (stages[k].free_inputs) {
      case 1:
        roll_stage<1>(stages[k], gains[k], steps + k);
        break;
      case 2:
        roll_stage<2>(stages[k], gains[k], steps + k);
        break;
      case 3:
        roll_stage<3>(stages[k], gains[k], steps + k);
        break;
      case 4:
        roll_stage<4>(stages[k], gains[k], steps + k);
        break;
      default:
        roll_stage<0>(stages[k], gains[k], steps + k);
        break;
    }
  }
  std::memset(steps[count].w, 0, sizeof(steps[count].w));
}

double cost_slope(const LqStage* stages, int count, const LqTerminal& terminal,
                  const LqStep* steps) noexcept {
  double slope = dot(terminal.q, steps[count].x);
  for (int k = 0; k < count; ++k) {
    slope += dot(stages[k].q, steps[k].x);
    for (int i = 0; i < stages[k].free_inputs; ++i) slope += stages[k].r[i] * steps[k].w[i];
  }
  return slope;
}

}  // namespace stilt::solver
