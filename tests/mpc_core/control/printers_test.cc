#include "tests/mpc_core/printers.h"

#include <gtest/gtest.h>

#include <memory>

namespace stilt::control {
namespace {

TEST(Printers, AStateIsPrintedWithTheNamesOfItsCoordinates) {
  model::StateVector state = model::StateVector::Zero();
  state[1] = 0.75;
  state[model::kPositions] = 0.5;
  EXPECT_EQ(
      testing::PrintToString(state),
      "[q: x_b 0 z_b 0.75 pitch_b 0 hip_L 0 knee_L 0 hip_R 0 knee_R 0 | v: x_b 0.5 z_b 0 pitch_b 0 hip_L 0 "
      "knee_L 0 hip_R 0 knee_R 0]");
}

TEST(Printers, APlanIsPrintedWithItsEnds) {
  const auto plan = std::make_unique<Plan>();
  EXPECT_EQ(testing::PrintToString(*plan), "plan -1: 0 nodes");
  plan->sequence = 7;
  plan->nodes = 3;
  plan->node[0].mode = {true, true};
  plan->node[2].time_s = 0.25;
  plan->node[2].mode = {false, true};
  const std::string text = testing::PrintToString(*plan);
  for (const char* part :
       {"plan 7: 3 nodes", "node 0 at 0 s, both feet", "node 2 at 0.25 s, right foot", "x = [q: x_b"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in " << text;
  }
}

}  // namespace
}  // namespace stilt::control
