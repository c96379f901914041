#include "codegen/expression/differentiate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stilt::codegen {
namespace {

TEST(DifferentiateTest, ElementaryRulesAreExact) {
  Graph graph;
  const Expression a = graph.symbol("a");
  const Expression b = graph.symbol("b");
  Differentiator d(std::vector{a, b});
  EXPECT_EQ(d(a * b, a), b);
  EXPECT_EQ(d(a + b, a), graph.constant(1.0));
  EXPECT_EQ(d(b - a, a), graph.constant(-1.0));
  EXPECT_EQ(d(graph.sine(a), a), graph.cosine(a));
  EXPECT_EQ(d(graph.cosine(a), a), -graph.sine(a));
  EXPECT_EQ(d(graph.sine(a), b), graph.constant(0.0));
  EXPECT_EQ(d(graph.symbol("other") * a, a), graph.symbol("other"));
}

TEST(DifferentiateTest, AgreesWithHighOrderDifferences) {
  constexpr unsigned kSeed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  Graph graph;
  const Expression a = graph.symbol("a");
  const Expression b = graph.symbol("b");
  const Expression f = graph.sine(a * b) / (a + graph.constant(2.0)) - b * b * graph.cosine(b - a) / (a * b);
  Differentiator d(std::vector{a, b});
  const Expression da = d(f, a);
  for (int i = 0; i < 100; ++i) {
    const double x = uniform(random);
    const double y = uniform(random);
    const auto value = [&](double at) { return graph.evaluate(f, {{"a", at}, {"b", y}}); };
    const double h = 1e-3;  // five points: error of order h^4
    const double difference =
        (8.0 * (value(x + h) - value(x - h)) - (value(x + 2 * h) - value(x - 2 * h))) / (12 * h);
    EXPECT_NEAR(graph.evaluate(da, {{"a", x}, {"b", y}}), difference, 1e-9);
  }
}

TEST(DifferentiateTest, ACutNodeHidesWhatStandsBeneathIt) {
  Graph graph;
  const Expression a = graph.symbol("a");
  const Expression b = graph.symbol("b");
  const Expression sum = a + b;
  const Expression f = graph.sine(sum) * a;
  Differentiator d(std::vector{sum, a});
  EXPECT_EQ(d(f, sum), graph.cosine(sum) * a);
  EXPECT_EQ(d(f, a), graph.sine(sum));
}

TEST(DifferentiateTest, ACutNodeMayCarryASignOrAConstantFactor) {
  Graph graph;
  const Expression a = graph.symbol("a");
  const Expression b = graph.symbol("b");
  const Expression difference = b - a;  // canonically the negation of a - b
  const Expression scaled = 4.0 * graph.sine(a);
  Differentiator d(std::vector{difference, scaled});
  EXPECT_EQ(d(difference * difference, difference), 2.0 * difference);
  EXPECT_EQ(d(0.5 * scaled, scaled), graph.constant(0.5));
  EXPECT_EQ(d(difference * scaled, scaled), difference);
}

TEST(DifferentiateTest, WrongVariablesAreRefused) {
  Graph graph;
  const Expression a = graph.symbol("a");
  const Expression b = graph.symbol("b");
  Differentiator d(std::vector{a});
  EXPECT_THROW(static_cast<void>(d(a * b, b)), std::invalid_argument);
  EXPECT_THROW(Differentiator(std::vector{graph.constant(2.0)}), std::invalid_argument);
}

}  // namespace
}  // namespace stilt::codegen
