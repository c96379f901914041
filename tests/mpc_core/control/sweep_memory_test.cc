#include <gtest/gtest.h>

#include <cstdio>

#include "mpc_core/control/planner.h"

/// The data that one Riccati sweep walks through stay in the second-level cache of 1 MiB per core, also at
/// the longest horizon. The sweep then never waits for main memory.
namespace stilt::lq {
namespace {

constexpr std::size_t kKibibyte = 1024;
constexpr std::size_t kSecondLevelCache = 1024 * kKibibyte;
constexpr std::size_t kNodes = 134;  ///< 2.0 s at 15 ms

constexpr std::size_t kStage = sizeof(LqFirstOrder) + sizeof(LqSecondOrder);

/// Backward: reads a stage, writes its gain. Forward: reads both and the projection of the
/// inputs, writes the step.
constexpr std::size_t kBackward =
    kNodes * (kStage + sizeof(LqGain)) + sizeof(LqTerminal) + sizeof(RiccatiWorkspace);
constexpr std::size_t kForward =
    kNodes * (sizeof(LqFirstOrder) + sizeof(InputProjection) + sizeof(LqGain) + sizeof(LqStep));

TEST(SweepMemory, OfTheLongestHorizonFitsTheSecondLevelCache) {
  std::printf("one sweep at %zu nodes: backward %zu, forward %zu of %zu KiB; a stage %zu bytes\n", kNodes,
              kBackward / kKibibyte, kForward / kKibibyte, kSecondLevelCache / kKibibyte, kStage);
  EXPECT_LE(kBackward, kSecondLevelCache);
  EXPECT_LE(kForward, kSecondLevelCache);
}

}  // namespace
}  // namespace stilt::lq
