#pragma once

#include <bit>

#include "mpc_core/lq/simd_columns.h"
#include "mpc_core/ocp/problem.h"
#include "mpc_core/ocp/projection.h"

/// Copies between per-stage rows and batches.
namespace stilt::ocp {

/// A batch as a register of the LQ solver; both have the lanes of the target.
static_assert(kLanes == lq::kLanes && sizeof(Batch) == sizeof(lq::Vec));
[[nodiscard]] inline lq::Vec as_vector(const Batch& batch) noexcept { return std::bit_cast<lq::Vec>(batch); }

/// Reads kCount numbers of each lane's row into kCount batches, by transposing squares of registers. Rows
/// must be padded to whole registers.
template <int kCount>
STILT_INLINE inline void load_rows(const double* const (&rows)[kLanes], Batch* out) noexcept {
  lq::unroll<(kCount + kLanes - 1) / kLanes>([&](auto part) STILT_INLINE {
    lq::Block block;
    lq::unroll<kLanes>([&](auto lane)
                           STILT_INLINE { block.column[lane] = lq::load(rows[lane] + part * kLanes); });
    lq::transpose(block);
    lq::unroll<kLanes>([&](auto i) STILT_INLINE {
      if constexpr (part * kLanes + i < kCount) {
        out[part * kLanes + i] = std::bit_cast<Batch>(block.column[i]);
      }
    });
  });
}

/// Writes kCount batches to each lane's row, beginning with register kFirstPart, and zeros up to the end of
/// the row. Rows are whole cache lines of 8 numbers, whatever the registers hold. `entry(i)` gives batch i.
template <int kCount, int kFirstPart = 0, class Entry>
STILT_INLINE inline void store_rows(double* const (&rows)[kLanes], const Entry& entry) noexcept {
  constexpr int kParts = (kCount + 7) / 8 * 8 / kLanes;
  lq::unroll<kParts - kFirstPart>([&](auto index) STILT_INLINE {
    constexpr int kPart = index + kFirstPart;
    lq::Block block;
    lq::unroll<kLanes>([&](auto i) STILT_INLINE {
      if constexpr (kPart * kLanes + i < kCount) {
        block.column[i] = as_vector(entry(std::integral_constant<int, kPart * kLanes + i>{}));
      } else {
        block.column[i] = lq::Vec{};
      }
    });
    lq::transpose(block);
    lq::unroll<kLanes>([&](auto lane)
                           STILT_INLINE { lq::store(rows[lane] + kPart * kLanes, block.column[lane]); });
  });
}

/// States and inputs of a batch of stages, and the states at their ends.
struct BatchIterate {
  Batch x[model::kStates];
  Batch u[model::kInputs];
  Batch x_next[model::kStates];

  BatchIterate() = default;
  BatchIterate(const Trajectory& iterate, const StageBatch& batch) noexcept {
    const double* rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = iterate.x[batch.stage[lane]];
    load_rows<model::kStates>(rows, x);
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] += lq::kRows;
    load_rows<model::kStates>(rows, x_next);
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = iterate.u[batch.stage[lane]];
    load_rows<model::kInputs>(rows, u);
  }
};

/// States before and after a batch of transitions.
struct BatchTransition {
  Batch x[model::kStates];
  Batch x_next[model::kStates];

  BatchTransition(const Trajectory& iterate, const TransitionBatch& batch) noexcept {
    const double* rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = iterate.x[batch.stage[lane]];
    load_rows<model::kStates>(rows, x);
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] += lq::kRows;
    load_rows<model::kStates>(rows, x_next);
  }
};

/// The robot's armature and damping, broadcast.
struct BatchParameters {
  Batch value[2 * model::kJoints];

  explicit BatchParameters(const ProblemData& data) noexcept {
    for (int i = 0; i < 2 * model::kJoints; ++i) value[i] = Batch(data.joint_parameters[i]);
  }
};

/// Calls `kernel(ModeTraits<...>{})` for the batch's contact mode.
template <class Kernel>
void dispatch(const model::ContactMode& mode, Kernel&& kernel) noexcept {
  if (mode.left && mode.right) {
    kernel(ModeTraits<true, true>{});
  } else if (mode.left) {
    kernel(ModeTraits<true, false>{});
  } else if (mode.right) {
    kernel(ModeTraits<false, true>{});
  } else {
    kernel(ModeTraits<false, false>{});
  }
}

}  // namespace stilt::ocp
