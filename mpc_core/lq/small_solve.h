#pragma once

#include <cmath>

/// Linear systems of a fixed, small size. Eigen's solvers query the sizes of the caches, which takes a lock.
namespace stilt::lq {

/// Gaussian elimination with partial pivoting: right = left^-1 right. Overwrites left. False when left is
/// singular.
template <class Left, class Right>
[[nodiscard]] bool solve_in_place(Left& left, Right& right) noexcept {
  constexpr int kSize = Left::RowsAtCompileTime;
  for (int k = 0; k < kSize; ++k) {
    int best = k;
    for (int r = k + 1; r < kSize; ++r) {
      if (std::abs(left(r, k)) > std::abs(left(best, k))) best = r;
    }
    if (!(std::abs(left(best, k)) > 0.0) || !std::isfinite(left(best, k))) return false;
    if (best != k) {
      left.row(k).swap(left.row(best));
      right.row(k).swap(right.row(best));
    }
    for (int r = k + 1; r < kSize; ++r) {
      const double factor = left(r, k) / left(k, k);
      left.row(r) -= factor * left.row(k);
      right.row(r) -= factor * right.row(k);
    }
  }
  for (int k = kSize - 1; k >= 0; --k) {
    right.row(k) /= left(k, k);
    for (int r = 0; r < k; ++r) right.row(r) -= left(r, k) * right.row(k);
  }
  return true;
}

}  // namespace stilt::lq
