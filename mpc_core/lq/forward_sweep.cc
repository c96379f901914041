#include "mpc_core/lq/riccati.h"
#include "mpc_core/lq/stage_mode.h"
#include "mpc_core/model/debug_assert.h"

namespace stilt::lq {
namespace {

/// Positions in a column of kRows scalar products with x. Unit row i of A is at its own state row, so that
/// the column can be added to the next state. Gains are at rows 3 to 6, constraints at 10 and 11.
inline constexpr int kGainPlace = 3;
inline constexpr int kConstraintPlace = 10;

template <class Mode>
constexpr int unit_at(int place) noexcept {
  for (int i = 0; i < Mode::kUnits; ++i) {
    if (Mode::row(i) == place) return i;
  }
  return -1;
}

/// The vector whose product with x belongs at position kPlace, or null.
template <class Mode, int kPlace>
STILT_INLINE inline const double* vector_at(const LqFirstOrder& stage, const LqGain& gain) noexcept {
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

/// Selects the positions of unit rows, clears the others.
template <class Mode, int kPart>
struct UnitLanes {
  static constexpr int at(int l) noexcept { return unit_at<Mode>(kPart * kLanes + l) >= 0 ? l : l + kLanes; }
};

/// Computes steps[1].x, steps[0].w and steps[0].c from steps[0].x.
template <class Mode>
STILT_INLINE inline void roll_stage(const LqFirstOrder& stage, const LqGain& gain, LqStep* steps) noexcept {
  const double* x = steps[0].x;
  const FreeMotion motion(stage.h);
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
      next[part] = free_motion<part>(x, motion);
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

void forward_sweep(const LqFirstOrder* stages, int count, const LqGain* gains, const double* x0,
                   LqStep* steps) noexcept {
  STILT_ASSERT(count >= 0);
  std::memcpy(steps[0].x, x0, sizeof(steps[0].x));
  for (int k = 0; k < count; ++k) {
    [[maybe_unused]] const bool known = dispatch(
        stages[k], [&]<class Mode>(Mode) STILT_INLINE { roll_stage<Mode>(stages[k], gains[k], steps + k); });
    STILT_ASSERT(known);
  }
  std::memset(steps[count].w, 0, sizeof(steps[count].w));
  std::memset(steps[count].c, 0, sizeof(steps[count].c));
}

double cost_slope(const LqFirstOrder* stages, int count, const LqTerminal& terminal,
                  const LqStep* steps) noexcept {
  double slope = dot(terminal.q, steps[count].x);
  for (int k = 0; k < count; ++k) {
    slope += dot(stages[k].q, steps[k].x);
    for (int i = 0; i < stages[k].free_inputs; ++i) slope += stages[k].r[i] * steps[k].w[i];
  }
  return slope;
}

}  // namespace stilt::lq
