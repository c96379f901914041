#include "mpc_core/lq/riccati.h"

#include <algorithm>
#include <cmath>

#include "mpc_core/lq/input_elimination.h"
#include "mpc_core/lq/stage_mode.h"
#include "mpc_core/model/debug_assert.h"

namespace stilt::lq {
namespace {

/// Both parts of one stage.
struct Stage {
  const LqFirstOrder& first;
  const LqSecondOrder& second;
};

/// Column c of [L, B, b].
template <class Mode>
STILT_INLINE inline const double* right_side(const LqFirstOrder& stage, int c) noexcept {
  if (c < Mode::kConstraints) return stage.L[c];
  if (c < Mode::kConstraints + Mode::kInputs) return stage.B[c - Mode::kConstraints];
  return stage.b;
}

/// The scalar products needed of columns of [L, B] with columns of X, as a list of pairs.
template <class Mode>
struct Dots {
  static constexpr int kLeft = Mode::kConstraints + Mode::kInputs;  ///< columns of [L, B]
  static constexpr int kCount = kLeft * (kLeft + 1) / 2 + kLeft;
  /// Index of [L, B]_i'X_j. The matrix [L, B]'P [L, B] is symmetric; only j <= i is stored.
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

/// Computes X = P [L, B, b], and adds p to the last column. The columns of L and B have (h/2 a, a) at
/// position and velocity of a joint. P times both is M a with M = h/2 P_position + P_velocity. b is the sum
/// of such a column and of a rest at the positions of the joints.
template <class Mode>
STILT_INLINE inline void value_products(const LqFirstOrder& stage, const ValueFunction& next,
                                        RiccatiWorkspace& work) noexcept {
  constexpr int kLast = Mode::kColumns - 1;
  for_each_tile<0, Mode::kColumns>([&]<int kFirst, int kCount>(Tile<kFirst, kCount>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      tile.v[c][p] = kFirst + c == kLast ? load(next.p + p * kLanes) : Vec{};
    });
    if constexpr (Mode::kHasDuration) {
      const double half_h = 0.5 * stage.h;
      constexpr int kFirstB = std::max(Mode::kConstraints - kFirst, 0);
#pragma GCC unroll 1  // short code: the sweep's exceeds half of the instruction cache
      for (int j = 0; j < model::kJoints; ++j) {
        const double* position = next.P[model::kFirstJoint + j];
        const double* velocity = next.P[kHalf + model::kFirstJoint + j];
        const auto M = [&](auto p) STILT_INLINE {
          if constexpr (kFirst > 0) return load(work.M[j] + p * kLanes);
          const Vec m = load(position + p * kLanes) * half_h + load(velocity + p * kLanes);
          if constexpr (kCount <= kLast) store(work.M[j] + p * kLanes, m);
          return m;
        };
        tile.add_registers(M, [&](auto c) STILT_INLINE {
          return right_side<Mode>(stage, kFirst + c)[kHalf + model::kFirstJoint + j];
        });
        tile.template add<kLast - kFirst>(position, [&](auto) STILT_INLINE {
          return stage.b[model::kFirstJoint + j] - half_h * stage.b[kHalf + model::kFirstJoint + j];
        });
      }
#pragma GCC unroll 1
      for (const int k : kBaseRow) {
        tile.template add<kFirstB>(
            next.P[k], [&](auto c) STILT_INLINE { return right_side<Mode>(stage, kFirst + c)[k]; });
      }
    } else {
      for (int k = 0; k < kStates; ++k) {
        tile.add(next.P[k], [&](auto c) STILT_INLINE { return right_side<Mode>(stage, kFirst + c)[k]; });
      }
    }
    tile.for_each([&](auto c, auto p) STILT_INLINE { store(work.X[kFirst + c] + p * kLanes, tile.v[c][p]); });
  });
}

/// Writes [L, B]'X to work.dots.
template <class Mode>
STILT_INLINE inline void scalar_products(const LqFirstOrder& stage, RiccatiWorkspace& work) noexcept {
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

/// Reads H and f_u from the scalar products.
template <class Mode>
STILT_INLINE inline InputTerms<Mode::kInputs> input_terms(const Stage& stage,
                                                          const RiccatiWorkspace& work) noexcept {
  constexpr int kInputs = Mode::kInputs;
  InputTerms<kInputs> terms;
  unroll<kInputs>([&](auto i) STILT_INLINE {
    constexpr int kB = Mode::kConstraints + i;
    unroll<i + 1>([&](auto j) STILT_INLINE {
      terms.H[i][j] = stage.second.R[j][i] + work.dots[Dots<Mode>::at(kB, Mode::kConstraints + j)];
    });
    terms.h[i] = stage.first.r[i] + work.dots[Dots<Mode>::at(kB, Mode::kColumns - 1)];
  });
  return terms;
}

/// The rows of [U, B, b]'P A, in this order: before() is v', after() is v'A = v'E + (v'U) G'.
template <class Mode>
struct Rows {
  static constexpr int kCount = Mode::kTerms + Mode::kInputs + 1;
  const ValueFunction& next;
  RiccatiWorkspace& work;

  [[nodiscard]] static constexpr int input(int row) noexcept { return row - Mode::kTerms; }
  /// Column of X of which the row is the transpose: for constraint terms, inputs, and last b.
  [[nodiscard]] static constexpr int column(int row) noexcept { return row - Mode::kUnits; }
  /// v
  template <int kRow>
  [[nodiscard]] STILT_INLINE const double* before() const noexcept {
    if constexpr (kRow < Mode::kUnits) {
      return next.P[Mode::row(kRow)];
    } else {
      return work.X[column(kRow)];
    }
  }
  /// (v'U)_j
  template <int kRow, int j>
  [[nodiscard]] STILT_INLINE double through() const noexcept {
    if constexpr (j < Mode::kUnits) {
      return before<kRow>()[Mode::row(j)];
    } else {
      return work.dots[Dots<Mode>::at(j - Mode::kUnits, column(kRow))];
    }
  }
  template <int kRow>
  [[nodiscard]] STILT_INLINE double* after() const noexcept {
    return kRow < Mode::kTerms ? work.W[kRow] : work.F[input(kRow)];
  }
};

/// Computes W, F and f_x.
template <class Mode>
STILT_INLINE inline void row_products(const Stage& stage, const ValueFunction& next, const FreeMotion& motion,
                                      RiccatiWorkspace& work) noexcept {
  const Rows<Mode> rows{next, work};
  for_each_tile<0, Rows<Mode>::kCount>([&]<int kFirst, int kCount>(Tile<kFirst, kCount>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      constexpr int kRow = kFirst + c;
      const double* v = rows.template before<kRow>();
      if constexpr (Mode::kHasDuration) {
        tile.v[c][p] = free_motion_transposed<p>(v, motion);
      } else {
        tile.v[c][p] = load(v + p * kLanes);
      }
      if constexpr (kRow == Mode::kTerms + Mode::kInputs) {
        tile.v[c][p] += load(stage.first.q + p * kLanes);
      } else if constexpr (kRow >= Mode::kTerms) {
        tile.v[c][p] += load(stage.second.S[kRow - Mode::kTerms] + p * kLanes);
      }
    });
    unroll<Mode::kTerms>([&](auto j) STILT_INLINE {
      constexpr int kFrom = j < kFirst ? 0 : j - kFirst;
      tile.template add<kFrom>(stage.first.G[j], [&](auto c) STILT_INLINE {
        const double factor = rows.template through<kFirst + c, j>();
        return kFirst + c == j ? 0.5 * factor : factor;
      });
    });
    tile.for_each([&](auto c, auto p)
                      STILT_INLINE { store(rows.template after<kFirst + c>() + p * kLanes, tile.v[c][p]); });
  });
}

/// Register kPart of column kColumn of N without the products: the shares of Q and of
///   E'P E = P + h P J + h J'P + h^2 J'P J,  J = [0 I; 0 0].
/// The share takes h P J whole, because h J'P is its transpose.
template <class Mode, int kColumn, int kPart>
STILT_INLINE inline Vec initial_half(const Stage& stage, const ValueFunction& next,
                                     const FreeMotion& motion) noexcept {
  constexpr int kDiagonal = kColumn / kLanes, kRow = kPart * kLanes;
  constexpr bool kVelocityColumn = Mode::kHasDuration && kColumn >= kHalf;
  const double* position = next.P[kVelocityColumn ? kColumn - kHalf : 0];
  Vec v{};
  if constexpr (kPart >= kDiagonal) {
    v = load(stage.second.Q[kColumn] + kRow) + load(next.P[kColumn] + kRow);
    if constexpr (kVelocityColumn)
      v += shifted_down<kPart>(position) * (motion.velocity[kPart] * broadcast(stage.first.h));
    if constexpr (kPart == kDiagonal) v = lower_half<kColumn % kLanes>(v);
  }
  if constexpr (kVelocityColumn) v += load(position + kRow) * broadcast(stage.first.h);
  return v;
}

/// Computes N by columns, with P = N + N'. N takes all of W'G. Of each symmetric term (Q, E'P E, y'z) it
/// takes the lower triangle with the diagonal halved.
template <class Mode>
STILT_INLINE inline void half_hessian(const Stage& stage, const ValueFunction& next, const FreeMotion& motion,
                                      const RiccatiWorkspace& work, double (*N)[kRows]) noexcept {
  const auto update = [&]<int kFirst, int kCount>(Tile<kFirst, kCount>& tile) STILT_INLINE {
    tile.for_each([&](auto c, auto p) STILT_INLINE {
      tile.v[c][p] = initial_half<Mode, kFirst + c, p>(stage, next, motion);
    });
    if constexpr (kFirst > 0) {
      unroll<Mode::kTerms>([&](auto i) STILT_INLINE {
        tile.add(work.W[i], [&](auto c) STILT_INLINE { return stage.first.G[i][kFirst + c]; });
      });
    }
    unroll<Mode::kInputs>([&](auto i) STILT_INLINE {
      unroll<kCount>([&](auto c) STILT_INLINE {
        constexpr int kDiagonal = (kFirst + c) / kLanes;
        const Vec z = broadcast(work.z[i][kFirst + c]);
        tile.v[c][kDiagonal] += load(work.half_y[i] + kDiagonal * kLanes) * z;
        unroll<kParts - 1 - kDiagonal>([&](auto below) STILT_INLINE {
          constexpr int kPart = kDiagonal + 1 + below;
          tile.v[c][kPart] += load(work.y[i] + kPart * kLanes) * z;
        });
      });
    });
    tile.for_each([&](auto c, auto p) STILT_INLINE { store(N[kFirst + c] + p * kLanes, tile.v[c][p]); });
  };
  for_each_tile<0, 1>(update);
  for_each_tile<1, kStates>(update);
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

/// Runs one stage of the backward sweep.
template <class Mode>
[[gnu::noinline]] SweepOutcome sweep_stage(const Stage& stage, const ValueFunction& next,
                                           ValueFunction& value, LqGain& gain,
                                           RiccatiWorkspace& work) noexcept {
  constexpr int kInputs = Mode::kInputs;
  const FreeMotion motion(stage.first.h);
  value_products<Mode>(stage.first, next, work);
  scalar_products<Mode>(stage.first, work);
  SweepOutcome outcome = SweepOutcome::ok;
  double z[kInputs > 0 ? kInputs : 1];
  if constexpr (kInputs > 0) {
    InputTerms<kInputs> terms = input_terms<Mode>(stage, work);
    double inverse_pivot[kInputs];
    outcome = factorise<kInputs>(terms.H, inverse_pivot);
    row_products<Mode>(stage, next, motion, work);
    solve_gains<kInputs>(terms, inverse_pivot, work, gain);
    solve_feedforward<kInputs>(terms, inverse_pivot, gain, z);
  } else {
    row_products<Mode>(stage, next, motion, work);
    std::memset(gain.K, 0, sizeof(gain.K));
  }
  unroll<kMaxFreeInputs - kInputs>([&](auto i) STILT_INLINE { gain.k[kInputs + i] = 0.0; });

  update_gradient<kInputs>(work, z, value.p);
  reload_values();
  half_hessian<Mode>(stage, next, motion, work, value.P);
  add_transpose(value.P);
  return outcome;
}

/// Copies the lower triangle of Q to both triangles of P.
void mirror_lower(const double (*Q)[kRows], double (*P)[kRows]) noexcept {
  for (int c = 0; c < kStates; ++c) {
    for (int r = 0; r < kRows; ++r) P[c][r] = r < c ? Q[r][c] : r < kStates ? Q[c][r] : 0.0;
  }
}

/// Whether every entry is finite: 0 * v is then zero, and otherwise NaN.
bool is_finite(const ValueFunction& value) noexcept {
  Vec zero{};
  for (const auto& column : value.P) {
    unroll<kParts>([&](auto part) STILT_INLINE { zero += load(column + part * kLanes) * broadcast(0.0); });
  }
  unroll<kParts>([&](auto part) STILT_INLINE { zero += load(value.p + part * kLanes) * broadcast(0.0); });
  return sum(zero) == 0.0;
}

[[maybe_unused]] bool padding_is_zero(const double* column) noexcept {
  for (int r = kStates; r < kRows; ++r) {
    if (column[r] != 0.0) return false;
  }
  return true;
}

/// Whether a column moves the joints by constant accelerations. Numbers that are not finite are reported
/// elsewhere.
[[maybe_unused]] bool accelerates_joints(const double* column, double h) noexcept {
  constexpr double kRounding = 1e-14;
  for (int r = model::kFirstJoint; r < kHalf; ++r) {
    const double moved = 0.5 * h * column[kHalf + r];
    if (std::isfinite(moved) && std::abs(column[r] - moved) > kRounding * std::abs(moved)) return false;
  }
  return true;
}

/// The structure of B and L in lq_problem.h.
[[maybe_unused]] bool well_formed(const LqFirstOrder& stage) noexcept {
  for (int i = 0; i < stage.free_inputs; ++i) {
    if (!accelerates_joints(stage.B[i], stage.h)) return false;
  }
  for (int i = 0; i < stage.constraints; ++i) {
    if (!accelerates_joints(stage.L[i], stage.h)) return false;
    for (const int row : kBaseRow) {
      if (stage.L[i][row] != 0.0) return false;
    }
  }
  return true;
}

/// Exactly symmetric with zero padding; a cost to go that is not finite is reported elsewhere.
[[maybe_unused]] bool well_formed(const ValueFunction& value) noexcept {
  for (int c = 0; c < kStates && is_finite(value); ++c) {
    if (!padding_is_zero(value.P[c])) return false;
    for (int r = 0; r < c; ++r) {
      if (value.P[c][r] != value.P[r][c]) return false;
    }
  }
  return true;
}

}  // namespace

BackwardSweep::BackwardSweep(const LqTerminal& terminal, RiccatiWorkspace& workspace) noexcept
    : workspace_(workspace), value_(&workspace.value[0]) {
  mirror_lower(terminal.Q, value_->P);
  std::memcpy(value_->p, terminal.q, sizeof(value_->p));
  STILT_ASSERT(padding_is_zero(terminal.q));
}

SweepOutcome BackwardSweep::step(const LqFirstOrder& first, const LqSecondOrder& second,
                                 LqGain& gain) noexcept {
  ValueFunction* before = value_ == &workspace_.value[0] ? &workspace_.value[1] : &workspace_.value[0];
  SweepOutcome outcome = SweepOutcome::bad_input_count;
  dispatch(first, [&]<class Mode>(Mode) STILT_INLINE {
    outcome = sweep_stage<Mode>({first, second}, *value_, *before, gain, workspace_);
  });
  value_ = before;
  STILT_ASSERT(outcome == SweepOutcome::bad_input_count || well_formed(first));
  STILT_ASSERT(outcome != SweepOutcome::ok || well_formed(*value_));
  return outcome;
}

bool BackwardSweep::finite() const noexcept { return is_finite(*value_); }

}  // namespace stilt::lq
