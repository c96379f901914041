#include <cmath>
#include <cstddef>
#include <experimental/simd>
#include <vector>

#include "tests/codegen/generated/robots.h"

namespace stilt::testing_support {
namespace {

namespace stdx = std::experimental;
using model::kInputs;
using model::kJoints;
using model::kStates;

constexpr unsigned kSeed = 51;
constexpr int kBatches = 100;

template <class Robot>
class BatchTest : public testing::Test {};
TYPED_TEST_SUITE(BatchTest, Robots);

/// Terms are plain arrays of their scalar: every element of a batch's lane against the scalar's.
template <class Batch, template <class> class Terms>
void expect_lane(const Terms<Batch>& batch, const Terms<double>& scalar, std::size_t lane) {
  constexpr std::size_t kElements = sizeof(Terms<double>) / sizeof(double);
  static_assert(sizeof(Terms<Batch>) == kElements * sizeof(Batch));
  const auto* of_batch = reinterpret_cast<const Batch*>(&batch);
  const auto* of_scalar = reinterpret_cast<const double*>(&scalar);
  double scale = 1.0;
  for (std::size_t i = 0; i < kElements; ++i) scale = std::max(scale, std::abs(of_scalar[i]));
  for (std::size_t i = 0; i < kElements; ++i) {
    const double value = of_batch[i][lane];
    ASSERT_NEAR(value, of_scalar[i], 1e-12 * scale) << "element " << i << " lane " << lane;
  }
}

template <class Robot, std::size_t kWidth>
void expect_batch_equals_scalar() {
  using Batch = stdx::simd<double, stdx::simd_abi::deduce_t<double, kWidth>>;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed << " width " << kWidth);
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < kBatches; ++n) {
    std::vector<Sample> samples;
    for (std::size_t lane = 0; lane < kWidth; ++lane) samples.emplace_back(random);
    Batch x[kStates];
    Batch u[kInputs];
    Batch p[2 * kJoints];
    for (std::size_t i = 0; i < kStates; ++i) x[i] = Batch([&](auto lane) { return samples[lane].x[i]; });
    for (std::size_t i = 0; i < kInputs; ++i) u[i] = Batch([&](auto lane) { return samples[lane].u[i]; });
    for (std::size_t i = 0; i < 2 * kJoints; ++i) p[i] = Batch([&](auto lane) { return samples[lane].p[i]; });
    const auto node = Robot::node_derivatives(x, u, p);
    const auto flow = Robot::flow(x, u);
    const auto left = Robot::impact_derivatives({.left = true}, x, p);
    const auto both = Robot::impact_derivatives({.left = true, .right = true}, x, p);
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const Sample& s = samples[lane];
      expect_lane(node, Robot::node_derivatives(s.x.data(), s.u.data(), s.p.data()), lane);
      expect_lane(flow, Robot::flow(s.x.data(), s.u.data()), lane);
      expect_lane(left, Robot::impact_derivatives({.left = true}, s.x.data(), s.p.data()), lane);
      expect_lane(both, Robot::impact_derivatives({.left = true, .right = true}, s.x.data(), s.p.data()),
                  lane);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TYPED_TEST(BatchTest, TwoLanesEqualTheScalar) { expect_batch_equals_scalar<TypeParam, 2>(); }

TYPED_TEST(BatchTest, LanesOfTheWidestRegisterEqualTheScalar) {
  expect_batch_equals_scalar<TypeParam, stdx::native_simd<double>::size()>();
}

}  // namespace
}  // namespace stilt::testing_support
