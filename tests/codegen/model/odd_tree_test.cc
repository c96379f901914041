#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "codegen/model/functions.h"
#include "codegen/urdf/urdf_reader.h"
#include "tests/codegen/model/mujoco_robot.h"

namespace stilt::codegen {
namespace {

/// A tree that is no five-link biped, evaluated from its expressions.
class OddTreeTest : public testing::Test {
 protected:
  OddTreeTest() {
    for (const auto& specs :
         {kinematic_functions(equations), node_functions(equations), impact_functions(equations, {0}),
          impact_functions(equations, {1}), impact_functions(equations, {0, 1})}) {
      for (const FunctionSpec& spec : specs) functions.emplace(spec.name, spec);
    }
  }

  /// Every argument of the emitted functions by its name there.
  std::map<std::string, double> random_arguments() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::map<std::string, double> values;
    for (int i = 0; i < 2 * n; ++i) values[element("x", i)] = (i < n ? 1.5 : 4.0) * uniform(random);
    for (int i = 0; i < joints; ++i) values[element("u", i)] = 30.0 * uniform(random);
    for (int i = 0; i < 2 * feet; ++i) values[element("u", joints + i)] = 100.0 * uniform(random);
    for (int i = 0; i < 2 * joints; ++i) values[element("joint_parameters", i)] = 0.5 + 0.4 * uniform(random);
    return values;
  }

  std::map<std::string, double> evaluate(const std::string& function,
                                         const std::map<std::string, double>& arguments) {
    std::map<std::string, double> values;
    for (const Output& output : functions.at(function).outputs) {
      values[output.path] = graph.evaluate(output.value, arguments);
    }
    return values;
  }

  static constexpr unsigned kSeed = 71;
  std::mt19937 random{kSeed};
  PlanarTree tree = read_urdf(STILT_SOURCE_DIR "/tests/codegen/data/odd_tree.urdf");
  Graph graph;
  Equations equations{graph, tree};
  std::map<std::string, FunctionSpec> functions;
  int n = tree.position_count();
  int joints = tree.joint_count();
  int feet = tree.foot_count();
};

TEST_F(OddTreeTest, ItsDynamicsAgreeWithMujoco) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  testing_support::MujocoRobot oracle(tree);
  ASSERT_EQ(oracle.size(), n);
  for (int sample = 0; sample < 20; ++sample) {
    auto arguments = random_arguments();
    std::vector<double> x;
    std::vector<double> force;
    std::vector<double> torque;
    auto node = evaluate("node", arguments);
    for (int i = 0; i < 2 * n; ++i) x.push_back(arguments[element("x", i)]);
    for (int i = 0; i < 2 * feet; ++i) force.push_back(arguments[element("u", joints + i)]);
    for (int j = 0; j < joints; ++j) {
      torque.push_back(node[element("joint_torque", j)]);
      oracle.set_joint(j, arguments[element("joint_parameters", j)],
                       arguments[element("joint_parameters", joints + j)]);
    }
    oracle.forward(x.data(), torque.data(), force.data());
    auto mass = evaluate("mass_matrix", arguments);
    auto bias = evaluate("bias", arguments);
    const std::vector<double> reference = oracle.mass_matrix();
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(bias[element("bias", i)], oracle.bias()[i], 1e-9 * 100.0);
      for (int j = 0; j < n; ++j) {
        EXPECT_NEAR(mass[element("mass_matrix", i, j)], reference[static_cast<std::size_t>(i * n + j)], 1e-9);
      }
      const double expected = i < 3 ? node[element("base_acceleration", i)] : arguments[element("u", i - 3)];
      EXPECT_NEAR(expected, oracle.acceleration()[i], 1e-9 * 30.0);
    }
    for (int r = 0; r < 2 * feet; ++r) {
      const auto axis = static_cast<std::size_t>(r % 2);
      EXPECT_NEAR(node[element("foot_position", r)], oracle.foot_position(r / 2)[axis], 1e-9);
      EXPECT_NEAR(node[element("foot_velocity", r)], oracle.foot_velocity(r / 2)[axis], 1e-9);
      EXPECT_NEAR(node[element("foot_acceleration", r)], oracle.foot_acceleration(r / 2)[axis], 1e-9 * 100.0);
    }
  }
}

/// Columns of `values` (a function of the arguments) by one argument against central differences of fourth
/// order.
TEST_F(OddTreeTest, ItsDerivativesAgreeWithHighOrderDifferences) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  constexpr double kStep = 1e-3;
  const auto arguments = random_arguments();
  const auto check = [&](const std::string& function, const std::string& suffix, const std::string& argument,
                         int column) {
    const auto derivatives = evaluate(function + "_derivatives", arguments);
    const auto shifted = [&](double shift) {
      auto moved = arguments;
      moved[argument] += shift;
      return evaluate(function, moved);
    };
    auto p1 = shifted(kStep);
    auto m1 = shifted(-kStep);
    auto p2 = shifted(2 * kStep);
    auto m2 = shifted(-2 * kStep);
    for (const auto& [path, value] : p1) {
      const std::size_t bracket = path.find('[');
      const std::string entry =
          path.substr(0, bracket) + suffix + path.substr(bracket) + "[" + std::to_string(column) + "]";
      if (!derivatives.contains(entry)) continue;
      const double difference = (8.0 * (value - m1[path]) - (p2[path] - m2[path])) / (12.0 * kStep);
      EXPECT_NEAR(derivatives.at(entry), difference, 1e-7 * std::max(1.0, std::abs(difference))) << entry;
    }
  };
  for (int i = 0; i < tree.link_count(); ++i) {
    check("node", "_dtheta", element("x", 2 + i), i);
    check("node", "_domega", element("x", n + 2 + i), i);
    check("impact_left", "_dtheta", element("x", 2 + i), i);
    check("impact_right", "_dtheta", element("x", 2 + i), i);
    check("impact_both", "_dtheta", element("x", 2 + i), i);
  }
  for (int i = 0; i < joints + 2 * feet; ++i) check("node", "_du", element("u", i), i);
  for (int i = 0; i < n; ++i) check("impact_right", "_dv", element("x", n + i), i);
  for (int i = 0; i < n; ++i) check("impact_both", "_dv", element("x", n + i), i);
}

}  // namespace
}  // namespace stilt::codegen
