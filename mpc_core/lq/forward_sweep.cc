#include "mpc_core/lq/riccati.h"
#include "mpc_core/lq/stage_mode.h"
#include "mpc_core/model/debug_assert.h"

// Why inputs are eliminated, and undone here: docs/decisions/0003-projected-multiple-shooting.md
namespace stilt::lq {
namespace {

/// Positions in a column of kRows scalar products with x. Unit row i of A is at its own state row, so that
/// the column can be added to the next state. Gains are at rows 3 to 6, constraints at 10 and 11, the force
/// that the stance constraint fixes at 12 and 13, the gradient of the cost at 14.
inline constexpr int kGainPlace = 3;
inline constexpr int kConstraintPlace = 10;
inline constexpr int kForcePlace = 12;
inline constexpr int kSlopePlace = 14;

inline constexpr int kInputParts = model::kInputs / kLanes;  ///< registers per input

template <class Mode>
constexpr int unit_at(int place) noexcept {
  for (int i = 0; i < Mode::kUnits; ++i) {
    if (Mode::row(i) == place) return i;
  }
  return -1;
}

/// The vector whose product with x belongs at position kPlace, or null.
template <class Mode, int kPlace>
STILT_INLINE inline const double* vector_at(const LqFirstOrder& stage, const InputProjection& inputs,
                                            const LqGain& gain) noexcept {
  constexpr int kInput = kPlace - kGainPlace, kConstraint = kPlace - kConstraintPlace;
  constexpr int kAxis = kPlace - kForcePlace;
  if constexpr (unit_at<Mode>(kPlace) >= 0) {
    return stage.G[unit_at<Mode>(kPlace)];
  } else if constexpr (kInput >= 0 && kInput < Mode::kInputs) {
    return gain.K[kInput];
  } else if constexpr (kConstraint >= 0 && kConstraint < Mode::kConstraints) {
    return stage.G[Mode::kUnits + kConstraint];
  } else if constexpr (Mode::kStands && kAxis >= 0 && kAxis < 2) {
    return inputs.F[kAxis];
  } else if constexpr (kPlace == kSlopePlace) {
    return stage.q;
  } else {
    return nullptr;
  }
}

/// Selects the positions of unit rows, clears the others.
template <class Mode, int kPart>
struct UnitLanes {
  static constexpr int at(int l) noexcept { return unit_at<Mode>(kPart * kLanes + l) >= 0 ? l : l + kLanes; }
};

/// Computes steps[1].x and the rest of steps[0] from steps[0].x. Returns the change of the cost.
template <class Mode>
STILT_INLINE inline double roll_stage(const LqFirstOrder& stage, const InputProjection& inputs,
                                      const LqGain& gain, LqStep* steps) noexcept {
  const double* x = steps[0].x;
  const FreeMotion motion(stage.h);
  alignas(64) double sums[kRows];
  Vec next[kParts];
  unroll<kParts>([&](auto part) STILT_INLINE {
    Block block;
    unroll<kLanes>([&](auto lane) STILT_INLINE {
      const double* row = vector_at<Mode, part * kLanes + lane>(stage, inputs, gain);
      block.column[lane] = row == nullptr ? Vec{} : lanes_of_dot(row, x);
    });
    const Vec total = column_sums(block);
    store(sums + part * kLanes, total);
    if constexpr (Mode::kHasDuration) {
      next[part] = free_motion<part>(x, motion);
    } else {
      next[part] = load(x + part * kLanes);
    }
    next[part] += load(stage.b + part * kLanes) + shuffle(total, Vec{}, UnitLanes<Mode, part>{});
  });
  Vec u[kInputParts];
  unroll<kInputParts>([&](auto part) STILT_INLINE { u[part] = load(inputs.u0 + part * kLanes); });
  const auto add = [&](const double* by_state, const double* by_input, double factor) STILT_INLINE {
    unroll<kParts>([&](auto part) STILT_INLINE { next[part] += load(by_state + part * kLanes) * factor; });
    unroll<kInputParts>([&](auto part) STILT_INLINE { u[part] += load(by_input + part * kLanes) * factor; });
  };
  double slope = sums[kSlopePlace] + inputs.u0_slope;
  unroll<kMaxConstraints>([&](auto i) STILT_INLINE {
    steps[0].c[i] = i < Mode::kConstraints ? sums[kConstraintPlace + i] : 0.0;
    if constexpr (i < Mode::kConstraints) add(stage.L[i], inputs.Y[i], steps[0].c[i]);
  });
  unroll<kMaxFreeInputs>([&](auto i) STILT_INLINE {
    steps[0].w[i] = i < Mode::kInputs ? gain.k[i] + sums[kGainPlace + i] : 0.0;
    if constexpr (i < Mode::kInputs) {
      add(stage.B[i], inputs.W[i], steps[0].w[i]);
      slope += stage.r[i] * steps[0].w[i];
    }
  });
  unroll<kParts>([&](auto part) STILT_INLINE { store(steps[1].x + part * kLanes, next[part]); });
  unroll<kInputParts>([&](auto part) STILT_INLINE { store(steps[0].u + part * kLanes, u[part]); });
  STILT_ASSERT(Mode::kStands == (inputs.first_force >= 0));
  if constexpr (Mode::kStands) {
    for (int axis = 0; axis < 2; ++axis) steps[0].u[inputs.first_force + axis] += sums[kForcePlace + axis];
  }
  return slope;
}

}  // namespace

double forward_sweep(const LqFirstOrder* stages, const InputProjection* inputs, int count,
                     const LqTerminal& terminal, const LqGain* gains, const double* x0,
                     LqStep* steps) noexcept {
  STILT_ASSERT(count >= 0);
  std::memcpy(steps[0].x, x0, sizeof(steps[0].x));
  double slope = 0.0;
  for (int k = 0; k < count; ++k) {
    [[maybe_unused]] const bool known = dispatch(stages[k], [&]<class Mode>(Mode) STILT_INLINE {
      slope += roll_stage<Mode>(stages[k], inputs[k], gains[k], steps + k);
    });
    STILT_ASSERT(known);
  }
  std::memset(steps[count].w, 0, sizeof(steps[count].w));
  std::memset(steps[count].c, 0, sizeof(steps[count].c));
  return slope + dot(terminal.q, steps[count].x);
}

}  // namespace stilt::lq
