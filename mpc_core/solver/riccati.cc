#include "mpc_core/solver/riccati.h"

#include "mpc_core/solver/simd_columns.h"

namespace stilt::solver {
namespace {

/// What is known of a stage at compile time.
template <int kFree, int kRankOne>
struct Flow {
  static constexpr bool kDrifts = true;  ///< h is not zero
  static constexpr int kInputs = kFree;
  static constexpr int kConstraints = kRankOne;
  static constexpr int kUnits = kBaseRows;                     ///< unit rows of A
  static constexpr int kTerms = kUnits + kConstraints;         ///< rows of G
  static constexpr int kColumns = kInputs + kConstraints + 1;  ///< of X = P [B, L, b]
  static constexpr int row(int unit) noexcept { return kBaseRow[unit]; }
};
struct Transition {
  static constexpr bool kDrifts = false;
  static constexpr int kInputs = 0;
  static constexpr int kConstraints = 0;
  static constexpr int kUnits = kHalf;
  static constexpr int kTerms = kUnits;
  static constexpr int kColumns = 1;
  static constexpr int row(int unit) noexcept { return kHalf + unit; }
};

/// Column c of [B, L, b].
template <class Mode>
STILT_INLINE inline const double* right_side(const LqStage& stage, int c) noexcept {
  if (c < Mode::kInputs) return stage.B[c];
  if (c < Mode::kInputs + Mode::kConstraints) return stage.L[c - Mode::kInputs];
  return stage.b;
}

/// The scalar products of columns of [B, L] with columns of X that are needed, as a list of pairs.
template <class Mode>
struct Dots {
  static constexpr int kLeft = Mode::kInputs + Mode::kConstraints;  ///< columns of [B, L]
  static constexpr int kCount = kLeft * (kLeft + 1) / 2 + kLeft;
  /// Place of [B, L]_i'X_j; the matrix [B, L]'P [B, L] is symmetric, and stored for j <= i alone.
  static constexpr int at(int i, int j) noexcept {
    if (j < kLeft && j > i) return at(j, i);
    return j < kLeft ? i * (i + 1) / 2 + j : kLeft * (kLeft + 1) / 2 + i;
  }
  static constexpr int left(int place) noexcept {
    for (int i = 0; i < kLeft; ++i) {
      for (int j = 0; j <= kLeft; ++j) {
        if ((j <= i || j == kLeft) && at(i, j) == place) return i;
      }
    }
    return -1;
  }
  static constexpr int right(int place) noexcept {
    for (int j = 0; j <= kLeft; ++j) {
      if ((j <= left(place) || j == kLeft) && at(left(place), j) == place) return j;
    }
    return -1;
  }
};

/// X = P [B, L, b], and p added to the last column.
template <class Mode>
STILT_INLINE inline void value_products(const LqStage& stage, const ValueFunction& next,
                                        RiccatiWorkspace& work) noexcept {
  for_each_tile<true, 0, Mode::kColumns>([&]<int kFirst, int kCount>(
                                             Tile<kFirst, kCount, true>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      tile.v[c][p] = kFirst + c == Mode::kColumns - 1 ? load(next.p + p * kLanes) : Vec{};
    });
    for (int k = 0; k < kStates; ++k) {
      tile.add(next.P[k], [&](auto c) STILT_INLINE { return right_side<Mode>(stage, kFirst + c)[k]; });
    }
    tile.for_each([&](auto c, auto p) STILT_INLINE { store(work.X[kFirst + c] + p * kLanes, tile.v[c][p]); });
  });
}

/// [B, L]'X into work.dots.
template <class Mode>
STILT_INLINE inline void scalar_products(const LqStage& stage, RiccatiWorkspace& work) noexcept {
  constexpr int kCount = Dots<Mode>::kCount;
  unroll<(kCount + kLanes - 1) / kLanes>([&](auto group) STILT_INLINE {
    Block block;
    unroll<kLanes>([&](auto lane) STILT_INLINE {
      constexpr int kPlace = group * kLanes + lane;
      if constexpr (kPlace < kCount) {
        block.column[lane] = lanes_of_dot(right_side<Mode>(stage, Dots<Mode>::left(kPlace)),
                                          work.X[Dots<Mode>::right(kPlace)]);
      } else {
        block.column[lane] = Vec{};
      }
    });
    store(work.dots + group * kLanes, column_sums(block));
  });
}

/// R + B'P B (lower triangle) and r + B'(P b + p).
template <int kInputs>
struct InputTerms {
  double H[kInputs][kInputs];
  double h[kInputs];
};

template <class Mode>
STILT_INLINE inline InputTerms<Mode::kInputs> input_terms(const LqStage& stage,
                                                          const RiccatiWorkspace& work) noexcept {
  constexpr int kInputs = Mode::kInputs;
  InputTerms<kInputs> terms;
  unroll<kInputs>([&](auto i) STILT_INLINE {
    unroll<i + 1>([&](auto j)
                      STILT_INLINE { terms.H[i][j] = stage.R[j][i] + work.dots[Dots<Mode>::at(i, j)]; });
    terms.h[i] = stage.r[i] + work.dots[Dots<Mode>::at(i, Mode::kColumns - 1)];
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

/// Gains and the two factors y, z of -F'H^-1 F = y'z, part by part.
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

/// Row i of U'P, a column of P or of X: the state row that A's term i goes to, or L_i, times P.
template <class Mode, int i>
STILT_INLINE inline const double* term_column(const ValueFunction& next,
                                              const RiccatiWorkspace& work) noexcept {
  if constexpr (i < Mode::kUnits) {
    return next.P[Mode::row(i)];
  } else {
    return work.X[Mode::kInputs + i - Mode::kUnits];
  }
}

/// Rows of [B, b, U]'P A, where A = E + U G': row = v' E + (v'U) G' with v' = B'P, b'P + p', U'P. The first
/// with S and q added are F and f_x; the last are T, with V = U'P E kept besides.
template <class Mode>
STILT_INLINE inline void row_products(const LqStage& stage, const ValueFunction& next, const Drift& drift,
                                      RiccatiWorkspace& work) noexcept {
  constexpr int kInputs = Mode::kInputs, kRows_ = kInputs + 1 + Mode::kTerms;
  const auto column = [&]<int kRow>(std::integral_constant<int, kRow>) STILT_INLINE -> const double* {
    if constexpr (kRow < kInputs) {
      return work.X[kRow];
    } else if constexpr (kRow == kInputs) {
      return work.X[Mode::kColumns - 1];
    } else {
      return term_column<Mode, kRow - kInputs - 1>(next, work);
    }
  };
  // (v'U)_j
  const auto through = [&]<int kRow, int j>(std::integral_constant<int, kRow> row,
                                            std::integral_constant<int, j>) STILT_INLINE -> double {
    if constexpr (j < Mode::kUnits) {
      return column(row)[Mode::row(j)];
    } else {
      constexpr int kL = kInputs + j - Mode::kUnits;
      constexpr int kTerm = kRow - kInputs - 1;
      if constexpr (kRow < kInputs) {
        return work.dots[Dots<Mode>::at(kL, kRow)];
      } else if constexpr (kRow == kInputs) {
        return work.dots[Dots<Mode>::at(kL, Mode::kColumns - 1)];
      } else if constexpr (kTerm < Mode::kUnits) {
        return work.X[kL][Mode::row(kTerm)];
      } else {
        return work.dots[Dots<Mode>::at(kL, kInputs + kTerm - Mode::kUnits)];
      }
    }
  };
  for_each_tile<true, 0, kRows_>([&]<int kFirst, int kCount>(Tile<kFirst, kCount, true>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      constexpr int kRow = kFirst + c;
      Vec v;
      if constexpr (Mode::kDrifts) {
        v = free_motion_transposed<p>(column(std::integral_constant<int, kRow>{}), drift);
      } else {
        v = load(column(std::integral_constant<int, kRow>{}) + p * kLanes);
      }
      if constexpr (kRow < kInputs) {
        v += load(stage.S[kRow] + p * kLanes);
      } else if constexpr (kRow == kInputs) {
        v += load(stage.q + p * kLanes);
      } else if constexpr (Mode::kDrifts) {
        store(work.V[kRow - kInputs - 1] + p * kLanes, v);
      }
      tile.v[c][p] = v;
    });
    unroll<Mode::kTerms>([&](auto j) STILT_INLINE {
      tile.add(stage.G[j],
               [&](auto c) STILT_INLINE { return through(std::integral_constant<int, kFirst + c>{}, j); });
    });
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      constexpr int kRow = kFirst + c;
      store((kRow <= kInputs ? work.F[kRow] : work.T[kRow - kInputs - 1]) + p * kLanes, tile.v[c][p]);
    });
  });
}

/// Register kPart of column kColumn of E'P E.
template <class Mode, int kColumn, int kPart>
STILT_INLINE inline Vec free_value(const ValueFunction& next, double h, const Drift& drift) noexcept {
  if constexpr (Mode::kDrifts) {
    Vec v = free_motion_transposed<kPart>(next.P[kColumn], drift);
    if constexpr (kColumn >= kHalf) {
      v += free_motion_transposed<kPart>(next.P[kColumn - kHalf], drift) * broadcast(h);
    }
    return v;
  } else {
    return load(next.P[kColumn] + kPart * kLanes);
  }
}

/// Lower triangle, by whole registers, of P = Q + A'P A + y'z, with A'P A = E'P E + V'G + G'T.
template <class Mode>
STILT_INLINE inline void update_hessian(const LqStage& stage, const ValueFunction& next, const Drift& drift,
                                        const RiccatiWorkspace& work, double (*P)[kRows]) noexcept {
  const auto update = [&]<int kFirst, int kCount>(Tile<kFirst, kCount, false>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      tile.v[c][p] =
          load(stage.Q[kFirst + c] + p * kLanes) + free_value<Mode, kFirst + c, p>(next, stage.h, drift);
    });
    unroll<Mode::kTerms>([&](auto i) STILT_INLINE {
      if constexpr (kFirst > 0) {
        const double* V = Mode::kDrifts ? work.V[i] : next.P[Mode::row(i < Mode::kUnits ? i : 0)];
        tile.add(V, [&](auto c) STILT_INLINE { return stage.G[i][kFirst + c]; });
      }
      tile.add(stage.G[i], [&](auto c) STILT_INLINE { return work.T[i][kFirst + c]; });
    });
    unroll<Mode::kInputs>([&](auto i) STILT_INLINE {
      tile.add(work.y[i], [&](auto c) STILT_INLINE { return work.z[i][kFirst + c]; });
    });
    tile.for_each([&](auto c, auto p) STILT_INLINE { store(P[kFirst + c] + p * kLanes, tile.v[c][p]); });
  };
  for_each_tile<false, 0, 1>(update);
  for_each_tile<false, 1, kStates>(update);
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

/// p = f_x + sum_i y_i z_i.
template <int kInputs>
STILT_INLINE inline void update_gradient(const RiccatiWorkspace& work, const double* z, double* p) noexcept {
  unroll<kParts>([&](auto part) STILT_INLINE {
    Vec v = load(work.F[kInputs] + part * kLanes);
    unroll<kInputs>([&](auto i) STILT_INLINE { v += load(work.y[i] + part * kLanes) * broadcast(z[i]); });
    store(p + part * kLanes, v);
  });
}

/// One stage of the backward sweep.
template <class Mode>
[[gnu::noinline]] SweepOutcome sweep_stage(const LqStage& stage, const ValueFunction& next,
                                           ValueFunction& value, LqGain& gain,
                                           RiccatiWorkspace& work) noexcept {
  constexpr int kInputs = Mode::kInputs;
  const Drift drift(stage.h);
  value_products<Mode>(stage, next, work);
  scalar_products<Mode>(stage, work);
  row_products<Mode>(stage, next, drift, work);

  SweepOutcome outcome = SweepOutcome::kOk;
  double z[kInputs > 0 ? kInputs : 1];
  if constexpr (kInputs > 0) {
    InputTerms<kInputs> terms = input_terms<Mode>(stage, work);
    double inverse_pivot[kInputs];
    outcome = factorise<kInputs>(terms.H, inverse_pivot);
    solve_gains<kInputs>(terms, inverse_pivot, work, gain);
    solve_feedforward<kInputs>(terms, inverse_pivot, gain, z);
  } else {
    std::memset(gain.K, 0, sizeof(gain.K));
  }
  unroll<kMaxFreeInputs - kInputs>([&](auto i) STILT_INLINE { gain.k[kInputs + i] = 0.0; });

  update_hessian<Mode>(stage, next, drift, work, value.P);
  mirror(value.P);
  update_gradient<kInputs>(work, z, value.p);
  return outcome;
}

/// Calls run(mode) with the compile-time facts of a stage; false when there are none.
template <class Run>
STILT_INLINE inline bool dispatch(const LqStage& stage, const Run& run) noexcept {
  const auto is = [&](StageForm form, int inputs, int constraints) STILT_INLINE {
    return stage.form == form && stage.free_inputs == inputs && stage.constraints == constraints;
  };
  if (is(StageForm::flow, 3, 1)) {
    run(Flow<3, 1>{});
  } else if (is(StageForm::flow, 4, 2)) {
    run(Flow<4, 2>{});
  } else if (is(StageForm::flow, 2, 2)) {
    run(Flow<2, 2>{});
  } else if (is(StageForm::transition, 0, 0)) {
    run(Transition{});
  } else {
    return false;
  }
  return true;
}

SweepOutcome sweep_any_stage(const LqStage& stage, const ValueFunction& next, ValueFunction& value,
                             LqGain& gain, RiccatiWorkspace& work) noexcept {
  SweepOutcome outcome = SweepOutcome::kBadInputCount;
  dispatch(stage, [&]<class Mode>(Mode)
                      STILT_INLINE { outcome = sweep_stage<Mode>(stage, next, value, gain, work); });
  return outcome;
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

/// The places of a column of kRows scalar products with x: unit row i of A stands at its own state row, so
/// that the sums can be added to the next state; gains stand at rows 3 to 6, constraints at 10 and 11.
inline constexpr int kGainPlace = 3;
inline constexpr int kConstraintPlace = 10;

template <class Mode>
constexpr int unit_at(int place) noexcept {
  for (int i = 0; i < Mode::kUnits; ++i) {
    if (Mode::row(i) == place) return i;
  }
  return -1;
}

/// The vector whose product with x belongs at a place, or null.
template <class Mode, int kPlace>
STILT_INLINE inline const double* vector_at(const LqStage& stage, const LqGain& gain) noexcept {
  constexpr int kInput = kPlace - kGainPlace, kConstraint = kPlace - kConstraintPlace;
  if constexpr (unit_at<Mode>(kPlace) >= 0) {
    return stage.G[unit_at<Mode>(kPlace)];
  } else if constexpr (kInput >= 0 && kInput < Mode::kInputs) {
    return gain.K[kInput];
  } else if constexpr (kConstraint >= 0 && kConstraint < Mode::kConstraints) {
    return stage.G[Mode::kUnits + kConstraint];
  } else {
    return nullptr;
  }
}

/// Keeps the places of unit rows, clears the others.
template <class Mode, int kPart>
struct UnitLanes {
  static constexpr int at(int l) noexcept { return unit_at<Mode>(kPart * kLanes + l) >= 0 ? l : l + kLanes; }
};

/// steps[1].x, steps[0].w and steps[0].c from steps[0].x.
template <class Mode>
STILT_INLINE inline void roll_stage(const LqStage& stage, const LqGain& gain, LqStep* steps) noexcept {
  const double* x = steps[0].x;
  const Drift drift(stage.h);
  alignas(64) double sums[kRows];
  Vec next[kParts];
  unroll<kParts>([&](auto part) STILT_INLINE {
    Block block;
    unroll<kLanes>([&](auto lane) STILT_INLINE {
      const double* row = vector_at<Mode, part * kLanes + lane>(stage, gain);
      block.column[lane] = row == nullptr ? Vec{} : lanes_of_dot(row, x);
    });
    const Vec total = column_sums(block);
    store(sums + part * kLanes, total);
    if constexpr (Mode::kDrifts) {
      next[part] = free_motion<part>(x, drift);
    } else {
      next[part] = load(x + part * kLanes);
    }
    next[part] += load(stage.b + part * kLanes) + shuffle(total, Vec{}, UnitLanes<Mode, part>{});
  });
  const auto add = [&](const double* column, double factor) STILT_INLINE {
    unroll<kParts>([&](auto part) STILT_INLINE { next[part] += load(column + part * kLanes) * factor; });
  };
  unroll<kMaxConstraints>([&](auto i) STILT_INLINE {
    steps[0].c[i] = i < Mode::kConstraints ? sums[kConstraintPlace + i] : 0.0;
    if constexpr (i < Mode::kConstraints) add(stage.L[i], steps[0].c[i]);
  });
  unroll<kMaxFreeInputs>([&](auto i) STILT_INLINE {
    steps[0].w[i] = i < Mode::kInputs ? gain.k[i] + sums[kGainPlace + i] : 0.0;
    if constexpr (i < Mode::kInputs) add(stage.B[i], steps[0].w[i]);
  });
  unroll<kParts>([&](auto part) STILT_INLINE { store(steps[1].x + part * kLanes, next[part]); });
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
    dispatch(stages[k],
             [&]<class Mode>(Mode) STILT_INLINE { roll_stage<Mode>(stages[k], gains[k], steps + k); });
  }
  std::memset(steps[count].w, 0, sizeof(steps[count].w));
  std::memset(steps[count].c, 0, sizeof(steps[count].c));
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
