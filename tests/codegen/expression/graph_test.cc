#include "codegen/expression/graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stilt::codegen {
namespace {

class GraphTest : public testing::Test {
 protected:
  Graph graph;
  Expression a = graph.symbol("a");
  Expression b = graph.symbol("b");
  Expression zero = graph.constant(0.0);
  Expression one = graph.constant(1.0);
};

TEST_F(GraphTest, EqualExpressionsAreOneNode) {
  EXPECT_EQ(a * b + graph.sine(a), a * b + graph.sine(a));
  const int size = graph.size();
  EXPECT_EQ(graph.symbol("a"), a);
  EXPECT_EQ(a * b + graph.sine(a), graph.sine(a) + b * a);
  EXPECT_EQ(graph.size(), size);
}

TEST_F(GraphTest, OperandsOfSumsAndProductsCommute) {
  EXPECT_EQ(a + b, b + a);
  EXPECT_EQ(a * b, b * a);
}

TEST_F(GraphTest, ConstantsFold) {
  EXPECT_TRUE(graph.is_constant(graph.constant(2.0) + graph.constant(3.0), 5.0));
  EXPECT_TRUE(graph.is_constant(graph.constant(2.0) - graph.constant(3.0), -1.0));
  EXPECT_TRUE(graph.is_constant(graph.constant(2.0) * graph.constant(3.0), 6.0));
  EXPECT_TRUE(graph.is_constant(graph.constant(3.0) / graph.constant(2.0), 1.5));
  EXPECT_TRUE(graph.is_constant(graph.sine(zero), 0.0));
  EXPECT_TRUE(graph.is_constant(graph.cosine(zero), 1.0));
  EXPECT_EQ(graph.constant(-0.0), zero);
}

TEST_F(GraphTest, NeutralAndAbsorbingElementsVanish) {
  EXPECT_EQ(a + zero, a);
  EXPECT_EQ(a - zero, a);
  EXPECT_EQ(zero - a, -a);
  EXPECT_EQ(a * one, a);
  EXPECT_EQ(a * zero, zero);
  EXPECT_EQ(a / one, a);
  EXPECT_EQ(zero / a, zero);
  EXPECT_EQ(a - a, zero);
  EXPECT_EQ(a / a, one);
}

TEST_F(GraphTest, WhatIsMadeOfConstantsAndParametersAloneIsACoefficient) {
  const Expression m = graph.parameter("m");
  const Expression l = graph.parameter("l");
  EXPECT_TRUE(graph.is_coefficient(one));
  EXPECT_TRUE(graph.is_coefficient(m * l + m * (l * l)));
  EXPECT_TRUE(graph.is_coefficient(-graph.sine(one / m)));
  EXPECT_FALSE(graph.is_coefficient(a));
  EXPECT_FALSE(graph.is_coefficient(m * a));
  EXPECT_FALSE(graph.is_coefficient(a + l));
}

TEST_F(GraphTest, CoefficientsOfOneVariableAreJoined) {
  const Expression m = graph.parameter("m");
  const Expression l = graph.parameter("l");
  EXPECT_EQ(m * (l * a), (m * l) * a);
  EXPECT_EQ((a * m) * l, (m * l) * a);
  EXPECT_EQ(m * a + l * a, (m + l) * a);
  EXPECT_EQ(m * a - l * a, (m - l) * a);
  EXPECT_EQ(a / m, (one / m) * a);
  EXPECT_EQ(m * (a * b), (a * b) * m);
}

TEST_F(GraphTest, SignsMoveOutwards) {
  EXPECT_EQ(-(-a), a);
  EXPECT_EQ((-a) * b, -(a * b));
  EXPECT_EQ((-a) * (-b), a * b);
  EXPECT_EQ((-a) / b, -(a / b));
  EXPECT_EQ(a / (-b), -(a / b));
  EXPECT_EQ(a + (-b), a - b);
  EXPECT_EQ((-a) + (-b), -(a + b));
  EXPECT_EQ(a - (-b), a + b);
  EXPECT_EQ(b - a, -(a - b));
  EXPECT_EQ(-1.0 * a, -a);
  EXPECT_EQ(-2.0 * a, -(2.0 * a));
}

TEST_F(GraphTest, SineIsOddAndCosineEven) {
  EXPECT_EQ(graph.sine(-a), -graph.sine(a));
  EXPECT_EQ(graph.cosine(-a), graph.cosine(a));
}

TEST_F(GraphTest, ConstantFactorsJoin) {
  EXPECT_EQ(2.0 * (3.0 * a), 6.0 * a);
  EXPECT_EQ(2.0 * (-3.0 * a), -6.0 * a);
  EXPECT_EQ(a / graph.constant(4.0), 0.25 * a);
  EXPECT_EQ(a + a, 2.0 * a);
  EXPECT_EQ(2.0 * a - 5.0 * a, -3.0 * a);
}

TEST_F(GraphTest, EvaluationFollowsTheMathematics) {
  const Expression e = graph.sine(a) * b - a / (b + graph.constant(2.0)) + graph.cosine(a * b);
  const double x = 0.7;
  const double y = -1.3;
  EXPECT_DOUBLE_EQ(graph.evaluate(e, {{"a", x}, {"b", y}}),
                   std::sin(x) * y - x / (y + 2.0) + std::cos(x * y));
}

TEST_F(GraphTest, ImpossibleConstantsAreRefused) {
  EXPECT_THROW(static_cast<void>(a / zero), std::domain_error);
  EXPECT_THROW(static_cast<void>(graph.constant(std::numeric_limits<double>::infinity())),
               std::invalid_argument);
}

}  // namespace
}  // namespace stilt::codegen
