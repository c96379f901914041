#include "hal/bring_up/absolute_turn.h"

#include <gtest/gtest.h>

#include <limits>

namespace stilt::hal {
namespace {

TEST(AbsoluteTurn, TheOneTurnInsideTheTravelIsTaken) {
  EXPECT_NEAR(only_turn(0.1, 1, 2, 2.9).value(), 2.1, 1e-12);
  EXPECT_NEAR(only_turn(0.1, 1, -0.95, -0.05).value(), -0.9, 1e-12);
  EXPECT_NEAR(only_turn(5.1, 1, -0.5, 0.4).value(), 0.1, 1e-12);
}

TEST(AbsoluteTurn, NoneOrTwoSayNothing) {
  EXPECT_FALSE(only_turn(0.1, 1, 2.2, 2.9));
  EXPECT_FALSE(only_turn(0.1, 1, 2, 3.2));
  EXPECT_FALSE(only_turn(0.1, 0, 2, 3));
  EXPECT_FALSE(only_turn(std::numeric_limits<double>::quiet_NaN(), 1, 0, 0.9));
  EXPECT_FALSE(only_turn(0.1, 1, 1, 0));
}

}  // namespace
}  // namespace stilt::hal
