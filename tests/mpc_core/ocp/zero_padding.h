#pragma once

#include <gtest/gtest.h>

#include "tests/mpc_core/ocp/planning_scene.h"

namespace stilt::testing_support {

/// Expects zero in the rows beyond the states, which the Riccati sweeps read.
inline void expect_zero_padding(const Linearisation& model) {
  for (std::size_t k = 0; k < model.stages.size(); ++k) {
    const LqStage& stage = model.stages[k];
    const ocp::InputProjection& projection = model.projections[k];
    for (int r = model::kStates; r < lq::kRows; ++r) {
      for (int c = 0; c < model::kStates; ++c) EXPECT_EQ(stage.Q[c][r], 0.0);
      const int terms =
          stage.form == lq::StageForm::flow ? lq::kBaseRows + stage.constraints : model::kPositions;
      for (int i = 0; i < terms; ++i) EXPECT_EQ(stage.G[i][r], 0.0);
      for (int i = 0; i < stage.constraints; ++i) EXPECT_EQ(stage.L[i][r], 0.0);
      for (int i = 0; i < stage.free_inputs; ++i) {
        EXPECT_EQ(stage.B[i][r], 0.0);
        EXPECT_EQ(stage.S[i][r], 0.0);
      }
      EXPECT_EQ(stage.b[r], 0.0);
      EXPECT_EQ(stage.q[r], 0.0);
      for (int axis = 0; axis < 2 && projection.first_force >= 0; ++axis)
        EXPECT_EQ(projection.F[axis][r], 0.0);
    }
  }
}

}  // namespace stilt::testing_support
