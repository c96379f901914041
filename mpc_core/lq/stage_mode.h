#pragma once

#include "mpc_core/lq/simd_columns.h"

/// The kinds of stages for which the Riccati sweeps have kernels, as types. Real-time safe.
namespace stilt::lq {

/// A flow with kFree inputs and kRankOne constraints. All modes have the same members. A is E (with h = 0
/// unless kHasDuration) plus kUnits unit rows row(i) G_i' plus kConstraints terms L_i G_{kUnits + i}'.
template <int kFree, int kRankOne>
struct Flow {
  static constexpr bool kHasDuration = true;  ///< h is not zero
  static constexpr bool kStands = kFree > 2;  ///< a foot is on the ground
  static constexpr int kInputs = kFree;
  static constexpr int kConstraints = kRankOne;
  static constexpr int kUnits = kBaseRows;                     ///< unit rows of A
  static constexpr int kTerms = kUnits + kConstraints;         ///< rows of G
  static constexpr int kColumns = kInputs + kConstraints + 1;  ///< of X = P [L, B, b]
  static constexpr int row(int unit) noexcept { return kBaseRow[unit]; }
};

/// A contact transition.
struct Transition {
  static constexpr bool kHasDuration = false;
  static constexpr bool kStands = false;
  static constexpr int kInputs = 0;
  static constexpr int kConstraints = 0;
  static constexpr int kUnits = kHalf;
  static constexpr int kTerms = kUnits;
  static constexpr int kColumns = 1;
  static constexpr int row(int unit) noexcept { return kHalf + unit; }
};

/// Calls run(mode) with the mode of a stage; false when no mode matches.
template <class Run>
STILT_INLINE inline bool dispatch(const LqFirstOrder& stage, const Run& run) noexcept {
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

}  // namespace stilt::lq
