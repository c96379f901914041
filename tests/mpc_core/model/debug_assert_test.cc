#include "mpc_core/model/debug_assert.h"

#include <gtest/gtest.h>

namespace stilt {
namespace {

#ifdef EIGEN_NO_DEBUG

TEST(DebugAssert, IsNotEvaluatedInThisBuild) {
  [[maybe_unused]] int evaluated = 0;
  STILT_ASSERT(++evaluated < 0);
  EXPECT_EQ(evaluated, 0);
}

#else

TEST(DebugAssert, EndsTheProgramWithTheConditionInThisBuild) {
  int evaluated = 0;
  STILT_ASSERT(++evaluated == 1);
  EXPECT_EQ(evaluated, 1);
  EXPECT_DEATH(STILT_ASSERT(evaluated == 2), "debug_assert_test.cc.*evaluated == 2");
}

#endif

}  // namespace
}  // namespace stilt
