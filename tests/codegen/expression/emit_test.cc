#include "codegen/expression/emit.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace stilt::codegen {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

EmittedFunction emit(std::vector<Output> outputs) {
  return emit_function(
      {.name = "f", .documentation = "What f is.", .parameters = {"x"}, .outputs = std::move(outputs)});
}

TEST(EmitTest, AFunctionIsATemplateOverScalarAndOutput) {
  Graph graph;
  const std::string text = emit({{"y", graph.symbol("x[0]") + graph.symbol("x[1]")}}).text;
  EXPECT_TRUE(contains(text, "/// What f is.\n"));
  EXPECT_TRUE(
      contains(text, "template <class T, class Out>\ninline void f(const T* x, Out& out) noexcept {\n"));
  EXPECT_TRUE(contains(text, "const T x_0 = x[0];"));
}

TEST(EmitTest, ASharedSubexpressionIsComputedOnce) {
  Graph graph;
  const Expression first = graph.symbol("x[0]");  // made before the other, so written before it
  const Expression p = first * graph.symbol("x[1]");
  const EmittedFunction f = emit({{"y[0]", p + graph.constant(1.0)}, {"y[1]", p * p}});
  EXPECT_EQ(f.count.multiplications, 2);
  EXPECT_EQ(f.count.additions, 1);
  ASSERT_TRUE(contains(f.text, "x_0 * x_1")) << f.text;
  EXPECT_EQ(f.text.find("x_0 * x_1"), f.text.rfind("x_0 * x_1")) << f.text;
}

TEST(EmitTest, CoefficientsAreReadFromOneTableForAllFunctions) {
  Graph graph;
  const Expression x = graph.symbol("x[0]");
  const Expression product = graph.parameter("p[0]") * graph.parameter("p[1]");
  const Expression inverse = graph.constant(1.0) / graph.parameter("p[0]");
  CoefficientTable table;
  const auto text = [&](const Expression& value) {
    return emit_function(
        {.name = "f", .documentation = "", .parameters = {"x", "k"}, .outputs = {{"y", value}}}, &table);
  };
  const EmittedFunction first = text(product * x);
  EXPECT_TRUE(contains(first.text, "out.y = k[0] * x_0;")) << first.text;
  EXPECT_FALSE(contains(first.text, "p[")) << first.text;
  EXPECT_EQ(first.count.total(), 1);
  EXPECT_TRUE(contains(text(inverse * x + product).text, "k[0] + k[1] * x_0"))
      << "its terms keep their places";
  ASSERT_EQ(table.entries().size(), 2U);
  EXPECT_EQ(table.entries()[0], product);
  EXPECT_EQ(table.entries()[1], inverse);
}

TEST(EmitTest, ANegativeConstantStandsInParentheses) {
  Graph graph;
  const std::string text = emit({{"y", graph.symbol("x[0]") + graph.constant(-3.0)}}).text;
  EXPECT_TRUE(contains(text, "(-3.0) + x_0")) << text;
}

TEST(EmitTest, DeadNodesAreNotEmitted) {
  Graph graph;
  const Expression a = graph.symbol("x[0]");
  const Expression dead = graph.sine(a) * graph.symbol("x[1]");
  const EmittedFunction f = emit({{"y", a + graph.constant(1.0)}});
  EXPECT_NE(dead, a);
  EXPECT_EQ(f.count.total(), 1);
  EXPECT_EQ(f.count.sine_cosine_pairs, 0);
  EXPECT_FALSE(contains(f.text, "x[1]"));
}

TEST(EmitTest, SineAndCosineOfAnAngleAreOnePair) {
  Graph graph;
  const Expression a = graph.symbol("x[0]");
  EXPECT_EQ(emit({{"y[0]", graph.sine(a)}, {"y[1]", graph.cosine(a)}}).count.sine_cosine_pairs, 1);
}

TEST(EmitTest, AConstantOutputIsWrittenAsTheScalarType) {
  Graph graph;
  EXPECT_TRUE(contains(emit({{"y", graph.constant(0.0)}}).text, "out.y = T(0.0);"));
}

TEST(EmitTest, NumbersReadBackExactly) {
  for (const double value : {0.1, 1.0, -3.0, 1e300, 4.9e-324, 1.0 / 3.0, 21.556520000000003}) {
    EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(number_text(2.0), "2.0");
}

}  // namespace
}  // namespace stilt::codegen
