#include "host_tools/cli/model_evaluation.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <random>
#include <sstream>

#include "firmware/robots/robots.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/plant/mjcf.h"
#include "host_tools/simulation/plant/physics_model.h"
#include "tests/robots.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;
using model::kFirstJoint;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// The same robot in MuJoCo, contacts off: forces at the feet are applied by hand.
class Oracle {
 public:
  explicit Oracle(const char* robot) {
    simulation::MjcfOptions options;
    options.contacts = false;
    physics_ =
        simulation::compile_mjcf(simulation::to_mjcf(robots::find(robot).value()->tree, options), index_);
    data_.reset(mj_makeData(physics_.get()));
  }

  void set(const model::StateVector& x) {
    for (int i = 0; i < kPositions; ++i) {
      data_->qpos[i] = x[i];
      data_->qvel[i] = x[kPositions + i];
    }
    mju_zero(data_->qfrc_applied, physics_->nv);
    mj_forward(physics_.get(), data_.get());
  }

  /// Generalised accelerations under joint torques and forces on the feet.
  [[nodiscard]] Eigen::Matrix<double, kPositions, 1> acceleration(const Json& torque_Nm, const Json& jacobian,
                                                                  const model::InputVector& u) {
    for (int i = 0; i < kPositions; ++i) {
      data_->qfrc_applied[i] =
          i < kFirstJoint ? 0.0 : torque_Nm[static_cast<std::size_t>(i - kFirstJoint)].get<double>();
      for (std::size_t row = 0; row < 4; ++row) {
        data_->qfrc_applied[i] +=
            jacobian[row][static_cast<std::size_t>(i)].get<double>() * u[kJoints + static_cast<int>(row)];
      }
    }
    mj_forward(physics_.get(), data_.get());
    return Eigen::Map<Eigen::Matrix<double, kPositions, 1>>(data_->qacc);
  }

  [[nodiscard]] Eigen::Matrix<double, kPositions, kPositions> mass_matrix() const {
    Eigen::Matrix<double, kPositions, kPositions, Eigen::RowMajor> full;
    mj_fullM(physics_.get(), full.data(), data_->qM);
    return full;
  }

  [[nodiscard]] const mjtNum* bias() const { return data_->qfrc_bias; }

  /// x or z row of a foot's Jacobian.
  [[nodiscard]] std::array<double, kPositions> jacobian_row(int foot, int axis) const {
    mjtNum all[3 * kPositions];
    mj_jacSite(physics_.get(), data_.get(), all, nullptr, index_.foot_site[static_cast<std::size_t>(foot)]);
    std::array<double, kPositions> row{};
    std::copy(all + axis * kPositions, all + (axis + 1) * kPositions, row.begin());
    return row;
  }

 private:
  simulation::PhysicsIndices index_;
  simulation::ModelPointer physics_;
  simulation::DataPointer data_;
};

void expect_close(double value, double expected, const char* what) {
  EXPECT_NEAR(value, expected, 1e-9 * std::max(1.0, std::abs(expected))) << what;
}

class ModelEvaluation : public testing::TestWithParam<const char*> {
 protected:
  void draw() {
    for (int i = 0; i < kStates; ++i) x_[i] = unit_(random_) * (i < kPositions ? 1.0 : 3.0);
    for (int i = 0; i < model::kInputs; ++i) u_[i] = unit_(random_) * (i < kJoints ? 20.0 : 200.0);
  }

  static constexpr unsigned kSeed = 11;
  std::mt19937 random_{kSeed};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  model::StateVector x_;
  model::InputVector u_;
};

TEST_P(ModelEvaluation, AgreesWithMuJoCo) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Oracle oracle(GetParam());
  for (int trial = 0; trial < 50; ++trial) {
    draw();
    const Json result = evaluate_model(*testing_support::find_robot(GetParam()), x_, u_);
    oracle.set(x_);
    const auto mass = oracle.mass_matrix();
    for (std::size_t i = 0; i < kPositions; ++i) {
      expect_close(result["bias"][i], oracle.bias()[i], "bias");
      for (std::size_t j = 0; j < kPositions; ++j) {
        expect_close(result["mass_matrix"][i][j], mass(static_cast<int>(i), static_cast<int>(j)),
                     "mass_matrix");
      }
    }
    for (int row = 0; row < 4; ++row) {
      const auto expected = oracle.jacobian_row(row / 2, row % 2 == 0 ? 0 : 2);
      for (std::size_t j = 0; j < kPositions; ++j) {
        expect_close(result["foot_jacobian"][static_cast<std::size_t>(row)][j], expected[j], "foot_jacobian");
      }
    }
    const auto acceleration = oracle.acceleration(result["joint_torque"], result["foot_jacobian"], u_);
    for (int i = 0; i < 3; ++i) {
      expect_close(result["base_acceleration"][static_cast<std::size_t>(i)], acceleration[i],
                   "base_acceleration");
    }
    for (int j = 0; j < kJoints; ++j)
      expect_close(u_[j], acceleration[kFirstJoint + j], "joint acceleration");
    for (std::size_t i = 0; i < kPositions; ++i) {
      expect_close(result["flow"][i], x_[kPositions + static_cast<int>(i)], "flow");
      expect_close(result["flow"][kPositions + i], acceleration[static_cast<int>(i)], "flow");
    }
  }
}

TEST_P(ModelEvaluation, DerivativesAgreeWithCentralDifferences) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  const model::RobotModel& robot = *testing_support::find_robot(GetParam());
  constexpr double kStep = 1e-5;
  draw();
  const Json at = evaluate_model(robot, x_, u_);
  const auto check = [&](double& variable, std::size_t column, const char* suffix) {
    const double centre = variable;
    variable = centre + kStep;
    const Json above = evaluate_model(robot, x_, u_);
    variable = centre - kStep;
    const Json below = evaluate_model(robot, x_, u_);
    variable = centre;
    for (const auto& [name, field] : {std::pair{"flow", "flow"},
                                      {"torque", "joint_torque"},
                                      {"foot_acceleration", "foot_acceleration"}}) {
      const Json& jacobian = at[std::string(name) + suffix];
      for (std::size_t row = 0; row < jacobian.size(); ++row) {
        const double slope =
            (above[field][row].get<double>() - below[field][row].get<double>()) / (2.0 * kStep);
        EXPECT_NEAR(jacobian[row][column].get<double>(), slope, 1e-6 * std::max(1.0, std::abs(slope)))
            << name << suffix << " row " << row << " column " << column;
      }
    }
  };
  for (int i = 0; i < kStates; ++i) check(x_[i], static_cast<std::size_t>(i), "_dx");
  for (int i = 0; i < model::kInputs; ++i) check(u_[i], static_cast<std::size_t>(i), "_du");
}

TEST_P(ModelEvaluation, AnImpactLeavesTheFeetAtRestAndBalancesMomentum) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  draw();
  const Json result = evaluate_model(*testing_support::find_robot(GetParam()), x_, u_);
  struct Landing {
    const char* feet;
    std::size_t first_row;  ///< of foot_jacobian
    std::size_t rows;
  };
  for (const auto& [side, first_row, rows] : {Landing{"left", 0, 2}, {"right", 2, 2}, {"both", 0, 4}}) {
    const Json& impact = result["impact"][side];
    ASSERT_EQ(impact["impulse"].size(), rows);
    for (std::size_t axis = 0; axis < rows; ++axis) {
      double speed = 0.0;
      for (std::size_t j = 0; j < kPositions; ++j) {
        speed += result["foot_jacobian"][first_row + axis][j].get<double>() *
                 impact["velocity_after"][j].get<double>();
      }
      EXPECT_NEAR(speed, 0.0, 1e-9) << side;
    }
    for (std::size_t i = 0; i < kPositions; ++i) {
      double balance = 0.0;
      for (std::size_t j = 0; j < kPositions; ++j) {
        balance += result["mass_matrix"][i][j].get<double>() *
                   (impact["velocity_after"][j].get<double>() - x_[kPositions + static_cast<int>(j)]);
      }
      for (std::size_t axis = 0; axis < rows; ++axis) {
        balance -= result["foot_jacobian"][first_row + axis][i].get<double>() *
                   impact["impulse"][axis].get<double>();
      }
      EXPECT_NEAR(balance, 0.0, 1e-9) << side << " row " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, ModelEvaluation, testing::Values("amber3m", "rabbit"));

TEST(ModelLines, EachLineIsAnsweredByOneLine) {
  const std::string zeros14 = "[0,0.8,0,0,0,0,0,0,0,0,0,0,0,0]", zeros8 = "[0,0,0,0,0,0,0,0]";
  const std::string line = "{\"x\": " + zeros14 + ", \"u\": " + zeros8 + "}\n";
  std::istringstream input(line + "\n" + line);
  std::ostringstream output;
  evaluate_lines(testing_support::amber3m(), input, output);
  std::istringstream lines(output.str());
  std::string text;
  int count = 0;
  while (std::getline(lines, text)) {
    ++count;
    EXPECT_NEAR(Json::parse(text)["foot_position"][1].get<double>(), 0.8 - 0.8731, 1e-12);
  }
  EXPECT_EQ(count, 2);
}

TEST(ModelLines, ALineThatIsNotSuchAnObjectIsRefusedWithItsNumber) {
  const std::string good = R"({"x": [0,0,0,0,0,0,0,0,0,0,0,0,0,0], "u": [0,0,0,0,0,0,0,0]})";
  for (const std::string bad :
       {"{", "[]", "3", R"({"x": [1,2], "u": [0,0,0,0,0,0,0,0]})", R"({"u": [0,0,0,0,0,0,0,0]})",
        R"({"x": [0,0,0,0,0,0,0,0,0,0,0,0,0,0]})", R"({"x": "no", "u": [0,0,0,0,0,0,0,0]})",
        R"({"x": [0,0,0,0,0,0,0,0,0,0,0,0,0,0], "u": [0,0,0,0,0,0,0,null]})"}) {
    std::istringstream input(good + "\n" + bad + "\n");
    std::ostringstream output;
    try {
      evaluate_lines(testing_support::amber3m(), input, output);
      ADD_FAILURE() << bad;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace stilt::cli
