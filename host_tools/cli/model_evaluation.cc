#include "host_tools/cli/model_evaluation.h"

#include <istream>
#include <ostream>
#include <string>

#include "host_tools/cli/usage_error.h"

namespace stilt::cli {
namespace {

using Json = nlohmann::ordered_json;
using model::kAngles;
using model::kFeet;
using model::kFirstAngle;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

template <int Rows, int Columns>
using Matrix = Eigen::Matrix<double, Rows, Columns>;

template <std::size_t Size>
Json row(const double (&values)[Size]) {
  return Json(values);
}

template <int Rows, int Columns>
Json rows(const Matrix<Rows, Columns>& matrix) {
  Json result = Json::array();
  for (int i = 0; i < Rows; ++i) {
    Json line = Json::array();
    for (int j = 0; j < Columns; ++j) line.push_back(matrix(i, j));
    result.push_back(std::move(line));
  }
  return result;
}

template <std::size_t Rows, std::size_t Columns>
auto matrix(const double (&values)[Rows][Columns]) {
  Matrix<static_cast<int>(Rows), static_cast<int>(Columns)> result;
  for (std::size_t i = 0; i < Rows; ++i) {
    for (std::size_t j = 0; j < Columns; ++j) result(static_cast<int>(i), static_cast<int>(j)) = values[i][j];
  }
  return result;
}

/// Derivative by the whole state from the derivatives by the angles and their rates; the others are zero.
template <std::size_t Rows>
auto by_state(const double (&by_theta)[Rows][kAngles], const double (&by_omega)[Rows][kAngles]) {
  Matrix<static_cast<int>(Rows), kStates> result;
  result.setZero();
  result.template middleCols<kAngles>(kFirstAngle) = matrix(by_theta);
  result.template middleCols<kAngles>(kPositions + kFirstAngle) = matrix(by_omega);
  return result;
}

/// Adds x' = [v; base acceleration; joint accelerations] and its derivatives.
void add_flow(Json& result, const model::StateVector& x, const model::InputVector& u,
              const model::NodeDerivatives<double>& node) {
  constexpr int kBaseRow = kPositions;
  constexpr int kJointRow = kPositions + 3;
  model::StateVector flow;
  flow << x.tail<kPositions>(), Eigen::Map<const Eigen::Vector3d>(node.base_acceleration), u.head<kJoints>();
  Matrix<kStates, kStates> flow_dx = Matrix<kStates, kStates>::Zero();
  flow_dx.topRightCorner<kPositions, kPositions>().setIdentity();
  flow_dx.middleRows<3>(kBaseRow) = by_state(node.base_acceleration_dtheta, node.base_acceleration_domega);
  Matrix<kStates, kInputs> flow_du = Matrix<kStates, kInputs>::Zero();
  flow_du.middleRows<3>(kBaseRow) = matrix(node.base_acceleration_du);
  flow_du.block<kJoints, kJoints>(kJointRow, 0).setIdentity();
  result["flow"] = rows<1, kStates>(flow.transpose())[0];
  result["flow_dx"] = rows(flow_dx);
  result["flow_du"] = rows(flow_du);
}

/// Impulse: [x, z] of each foot in contact.
Json impact(const model::RobotModel& robot, model::ContactMode contact, const model::StateVector& x) {
  model::ImpactTerms<double> terms;
  robot.impact(contact, x.data(), robot.constants.joint_parameters, terms);
  Json impulse = Json::array();
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!contact[foot]) continue;
    impulse.push_back(terms.impulse[2 * foot]);
    impulse.push_back(terms.impulse[2 * foot + 1]);
  }
  return {{"velocity_after", row(terms.velocity_after)}, {"impulse", impulse}};
}

/// The vector of exactly `size` numbers under `key`.
template <int Size>
Matrix<Size, 1> vector_field(const Json& object, const char* key, const std::string& where) {
  const std::string expected =
      where + ": \"" + key + "\" must be an array of " + std::to_string(Size) + " numbers";
  const auto field = object.find(key);
  if (field == object.end() || !field->is_array() || field->size() != Size) throw UsageError(expected);
  Matrix<Size, 1> result;
  for (int i = 0; i < Size; ++i) {
    const Json& value = (*field)[static_cast<std::size_t>(i)];
    if (!value.is_number()) throw UsageError(expected);
    result[i] = value.get<double>();
  }
  return result;
}

}  // namespace

Json evaluate_model(const model::RobotModel& robot, const model::StateVector& x,
                    const model::InputVector& u) {
  const double* parameters = robot.constants.joint_parameters;
  model::MassMatrixTerms<double> mass;
  model::BiasTerms<double> bias;
  model::KinematicsTerms<double> feet;
  model::NodeDerivatives<double> node;
  robot.mass_matrix(x.data(), parameters, mass);
  robot.bias(x.data(), bias);
  robot.kinematics(x.data(), feet);
  robot.node_derivatives(x.data(), u.data(), parameters, node);
  Json result;
  result["mass_matrix"] = rows(matrix(mass.mass_matrix));
  result["bias"] = row(bias.bias);
  result["foot_position"] = row(feet.foot_position);
  result["foot_velocity"] = row(feet.foot_velocity);
  result["foot_acceleration"] = row(node.foot_acceleration);
  result["foot_jacobian"] = rows(matrix(feet.foot_jacobian));
  result["base_acceleration"] = row(node.base_acceleration);
  result["joint_torque"] = row(node.joint_torque);
  add_flow(result, x, u, node);
  result["torque_dx"] = rows(by_state(node.joint_torque_dtheta, node.joint_torque_domega));
  result["torque_du"] = rows(matrix(node.joint_torque_du));
  result["foot_acceleration_dx"] =
      rows(by_state(node.foot_acceleration_dtheta, node.foot_acceleration_domega));
  result["foot_acceleration_du"] = rows(matrix(node.foot_acceleration_du));
  result["impact"] = {{"left", impact(robot, {.left = true}, x)},
                      {"right", impact(robot, {.right = true}, x)},
                      {"both", impact(robot, {.left = true, .right = true}, x)}};
  return result;
}

void evaluate_lines(const model::RobotModel& robot, std::istream& input, std::ostream& output) {
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = "standard input, line " + std::to_string(number);
    const Json object = Json::parse(line, nullptr, false);
    if (!object.is_object()) {
      throw UsageError(where + ": expected one JSON object, {\"x\": [14 numbers], \"u\": [8 numbers]}");
    }
    const auto x = vector_field<kStates>(object, "x", where);
    const auto u = vector_field<kInputs>(object, "u", where);
    output << evaluate_model(robot, x, u).dump() << '\n';
  }
  output.flush();
}

}  // namespace stilt::cli
