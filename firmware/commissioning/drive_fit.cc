#include "firmware/commissioning/drive_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "firmware/commissioning/zero_phase.h"

namespace stilt::commissioning {
namespace {

constexpr int kUnknowns = 5;
using Row = Eigen::Matrix<double, kUnknowns, 1>;
using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;

constexpr double kCutoff_hz = 8.0;
constexpr double kEnds_s = 0.4;
constexpr double kSlow_rad_s = 0.05;
constexpr double kAroundSlow_s = 0.06;  // half of the filter's 1 / 8 Hz
constexpr double kCluster_s = 0.5;

/// An equation: row . unknowns = asked_Nm; unknowns 1 / k, I / k, d / k, c / k, -tau_0 / k.
struct Equation {
  Row row;
  double asked_Nm;
  std::size_t cluster;
};

/// Torque of the joint's row for rigid links and drives without mass, the hip standing still.
double rigid_torque_Nm(const model::RobotModel& robot, std::size_t joint,
                       const std::array<double, model::kAngles>& angle,
                       const std::array<double, model::kAngles>& rate,
                       const std::array<double, model::kAngles>& acceleration) {
  double x[model::kStates] = {};
  for (int i = 0; i < model::kAngles; ++i) {
    const auto at = static_cast<std::size_t>(i);
    x[model::kFirstAngle + i] = angle[at];
    x[model::kPositions + model::kFirstAngle + i] = rate[at];
  }
  const double no_drives[2 * model::kJoints] = {};
  model::MassMatrixTerms<double> mass;
  model::BiasTerms<double> bias;
  robot.mass_matrix(x, no_drives, mass);
  robot.bias(x, bias);
  const int row = model::kFirstJoint + static_cast<int>(joint);
  double torque_Nm = bias.bias[row];
  for (int i = 0; i < model::kAngles; ++i) {
    torque_Nm += mass.mass_matrix[row][model::kFirstAngle + i] * acceleration[static_cast<std::size_t>(i)];
  }
  return torque_Nm;
}

/// The filtered signals of a record.
struct Motion {
  std::array<std::vector<double>, model::kAngles> angle, rate, acceleration;
  std::vector<double> torque_Nm, sign;
};

Motion filtered(const DriveRecord& record, std::size_t joint, double period_s) {
  Motion motion;
  for (std::size_t i = 0; i < model::kAngles; ++i) {
    motion.angle[i] = zero_phase_filtered(record.angle_rad[i], kCutoff_hz, period_s);
    motion.rate[i] = derivative(motion.angle[i], period_s);
    motion.acceleration[i] = derivative(motion.rate[i], period_s);
  }
  motion.torque_Nm = zero_phase_filtered(record.torque_Nm, kCutoff_hz, period_s);
  for (const double rate : motion.rate[1 + joint]) motion.sign.push_back(rate > 0 ? 1 : -1);
  motion.sign = zero_phase_filtered(motion.sign, kCutoff_hz, period_s);
  return motion;
}

std::array<double, model::kAngles> at(const std::array<std::vector<double>, model::kAngles>& signals,
                                      std::size_t i) {
  std::array<double, model::kAngles> values;
  for (std::size_t angle = 0; angle < model::kAngles; ++angle) values[angle] = signals[angle][i];
  return values;
}

/// Times at which the joint is slow, and those around them that the filter mixes with them. A joint that
/// sticks has any friction up to c, whatever the sign of its rate.
std::vector<bool> slow_times(const std::vector<double>& rate, double period_s) {
  const auto around = std::lround(kAroundSlow_s / period_s);
  const auto count = std::ssize(rate);
  std::vector<bool> slow(rate.size(), false);
  std::ptrdiff_t marked = 0;  // all before are judged
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (std::abs(rate[static_cast<std::size_t>(i)]) >= kSlow_rad_s) continue;
    const std::ptrdiff_t end = std::min(count, i + around + 1);
    for (marked = std::max(marked, i - around); marked < end; ++marked) {
      slow[static_cast<std::size_t>(marked)] = true;
    }
  }
  return slow;
}

void add_equations(const model::RobotModel& robot, std::size_t joint, const DriveRecord& record,
                   double period_s, std::vector<Equation>& equations) {
  const auto ends = static_cast<std::size_t>(std::lround(kEnds_s / period_s));
  const auto cluster = static_cast<std::size_t>(std::lround(kCluster_s / period_s));
  const std::size_t count = record.torque_Nm.size();
  if (count <= 2 * ends + 2) return;
  const std::size_t first_cluster = equations.empty() ? 0 : equations.back().cluster + 1;
  const Motion motion = filtered(record, joint, period_s);
  const std::vector<bool> slow = slow_times(motion.rate[1 + joint], period_s);
  for (std::size_t i = ends; i + ends < count; ++i) {
    if (slow[i]) continue;
    Row row;
    row << rigid_torque_Nm(robot, joint, at(motion.angle, i), at(motion.rate, i), at(motion.acceleration, i)),
        motion.acceleration[1 + joint][i], motion.rate[1 + joint][i], motion.sign[i], 1;
    equations.push_back({row, motion.torque_Nm[i], first_cluster + (i - ends) / cluster});
  }
}

/// 0.975 quantile of Student's t within 0.5 % from 10 degrees of freedom on: 1.96 + 2.4 / n + 3 / n^2.
double student_quantile(double degrees) { return 1.96 + 2.4 / degrees + 3 / (degrees * degrees); }

/// k, I, d, c and tau_0 from the unknowns.
Row drive_values(const Row& unknowns) {
  Row values = unknowns / unknowns[0];
  values[0] = 1 / unknowns[0];
  values[4] = -values[4];
  return values;
}

/// Of drive_values().
Square drive_jacobian(const Row& unknowns) {
  Square jacobian = Square::Identity() / unknowns[0];
  jacobian.col(0) = -unknowns / (unknowns[0] * unknowns[0]);
  jacobian(0, 0) = -1 / (unknowns[0] * unknowns[0]);
  jacobian.row(4) = -jacobian.row(4);
  return jacobian;
}

struct Residuals {
  Square scatter = Square::Zero();  ///< of the clusters' sums of row times residual
  double squares_Nm2 = 0;
};

Residuals residuals(const std::vector<Equation>& equations, const Row& solution) {
  Residuals all;
  Row sum = Row::Zero();
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const Equation& equation = equations[i];
    const double residual_Nm = equation.asked_Nm - equation.row.dot(solution);
    all.squares_Nm2 += residual_Nm * residual_Nm;
    sum += equation.row * residual_Nm;
    if (i + 1 < equations.size() && equations[i + 1].cluster == equation.cluster) continue;
    all.scatter += sum * sum.transpose();
    sum.setZero();
  }
  return all;
}

}  // namespace

DriveNumbers fit_drive(const model::RobotModel& robot, std::size_t joint,
                       std::span<const DriveRecord> records, double period_s) {
  std::vector<Equation> equations;
  for (const DriveRecord& record : records) add_equations(robot, joint, record, period_s, equations);
  DriveNumbers numbers;
  Square normal = Square::Zero();
  Row right = Row::Zero();
  for (const Equation& equation : equations) {
    normal += equation.row * equation.row.transpose();
    right += equation.row * equation.asked_Nm;
  }
  const Eigen::LDLT<Square> factored(normal);
  const std::size_t clusters = equations.empty() ? 0 : equations.back().cluster + 1;
  if (clusters <= 2 * kUnknowns || factored.info() != Eigen::Success || !factored.isPositive())
    return numbers;
  const Row solution = factored.solve(right);
  const Residuals rest = residuals(equations, solution);
  const Square inverse = factored.solve(Square::Identity());
  const double degrees = static_cast<double>(clusters - kUnknowns);
  const Square covariance = static_cast<double>(clusters) / degrees * inverse * rest.scatter * inverse;
  const Row values = drive_values(solution);
  const Square jacobian = drive_jacobian(solution);
  const Square of_values = jacobian * covariance * jacobian.transpose();
  const auto estimate = [&](int i) {
    return Estimate{values[i], student_quantile(degrees) * std::sqrt(of_values(i, i))};
  };
  return {.torque_factor = estimate(0),
          .armature_kg_m2 = estimate(1),
          .damping_Nms_rad = estimate(2),
          .coulomb_friction_Nm = estimate(3),
          .torque_offset_Nm = estimate(4),
          .residual_Nm = std::sqrt(rest.squares_Nm2 / static_cast<double>(equations.size())),
          .samples = equations.size()};
}

}  // namespace stilt::commissioning
