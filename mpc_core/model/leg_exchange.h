#pragma once

#include <algorithm>

#include "mpc_core/model/terms.h"

/// Exchange of left and right. Both legs of a robot are equal. The impact of the right foot is therefore that
/// of the left foot of the mirrored robot. With S the exchange, f_R(x, p) = S f_L(S x, S p). Real-time safe.
namespace stilt::model {

/// Index of the same quantity in the other leg.
[[nodiscard]] constexpr int other_leg(int index, int first_joint) noexcept {
  constexpr int kLegJoints = kJoints / kFeet;
  if (index < first_joint) return index;
  return index < first_joint + kLegJoints ? index + kLegJoints : index - kLegJoints;
}

/// State, armature and damping of the joints with the legs exchanged.
template <class T>
struct ExchangedArguments {
  T x[kStates];
  T p[2 * kJoints];

  ExchangedArguments(const T* state, const T* parameters) noexcept {
    for (int i = 0; i < kPositions; ++i) {
      const int other = other_leg(i, kFirstJoint);
      x[i] = state[other];
      x[kPositions + i] = state[kPositions + other];
    }
    for (int j = 0; j < kJoints; ++j) {
      p[j] = parameters[other_leg(j, 0)];
      p[kJoints + j] = parameters[kJoints + other_leg(j, 0)];
    }
  }
};

namespace detail {

/// Exchanges the legs in a row whose last kJoints columns are the joints.
template <class T, int kColumns>
void exchange_columns(const T (&from)[kColumns], T (&to)[kColumns]) noexcept {
  constexpr int kFirst = kColumns - kJoints;
  for (int c = 0; c < kColumns; ++c) to[c] = from[other_leg(c, kFirst)];
}

}  // namespace detail

/// Impact of one foot from that of the other foot on the mirrored robot.
template <class T>
void exchange_legs(const ImpactTerms<T>& from, ImpactTerms<T>& to) noexcept {
  detail::exchange_columns(from.velocity_after, to.velocity_after);
  std::rotate_copy(from.impulse, from.impulse + 2, from.impulse + 2 * kFeet, to.impulse);
}

/// The same with derivatives.
template <class T>
void exchange_legs(const ImpactDerivatives<T>& from, ImpactDerivatives<T>& to) noexcept {
  detail::exchange_columns(from.velocity_after, to.velocity_after);
  for (int r = 0; r < kPositions; ++r) {
    const int other = other_leg(r, kFirstJoint);
    detail::exchange_columns(from.velocity_after_dtheta[other], to.velocity_after_dtheta[r]);
    detail::exchange_columns(from.velocity_after_dv[other], to.velocity_after_dv[r]);
  }
  for (int r = 0; r < 2 * kFeet; ++r) {
    const int other = (r + 2) % (2 * kFeet);
    to.impulse[r] = from.impulse[other];
    detail::exchange_columns(from.impulse_dtheta[other], to.impulse_dtheta[r]);
    detail::exchange_columns(from.impulse_dv[other], to.impulse_dv[r]);
  }
}

}  // namespace stilt::model
