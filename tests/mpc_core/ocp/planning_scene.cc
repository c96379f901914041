#include "tests/mpc_core/ocp/planning_scene.h"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

#include "mpc_core/ocp/linearise.h"

namespace stilt::testing_support {
namespace {

using model::kFeet;
using model::kInputs;
using model::kJoints;
using model::kPositions;
using model::kStates;

/// Joint rates that give the feet these velocities, the base moving as in `state`.
void set_joint_rates(const model::RobotModel& robot, const model::FeetVector& foot_velocity_W_m_s,
                     model::StateVector& state) {
  model::KinematicsTerms<double> feet;
  robot.kinematics(state.data(), feet);
  Eigen::Matrix<double, 2 * kFeet, kPositions> jacobian;
  for (int r = 0; r < 2 * kFeet; ++r) {
    for (int c = 0; c < kPositions; ++c) jacobian(r, c) = feet.foot_jacobian[r][c];
  }
  const model::FeetVector from_base = jacobian.leftCols<3>() * state.segment<3>(kPositions);
  const Eigen::Matrix4d by_joints = jacobian.rightCols<kJoints>();
  state.tail<kJoints>() = by_joints.partialPivLu().solve(foot_velocity_W_m_s - from_base);
}

model::StateVector mid_stride(const SceneOptions& options, model::ContactMode mode, double progress) {
  const double half_width_m = mode.count() == 1 ? 0.03 : 0.15;
  // The stance foot falls behind the hip as the step progresses.
  const bool left_ahead = mode.count() == 2 || (mode.left == (progress < 0.5));
  model::StateVector state = gait::standing_state(options.robot->constants, options.reference.base_height_m,
                                                  options.reference.base_pitch_rad, half_width_m, left_ahead);
  const double speed_m_s = mode.count() == 1 ? options.command.speed_m_s : 0.0;
  state[kPositions] = speed_m_s;
  model::FeetVector feet = model::FeetVector::Zero();
  for (int foot = 0; foot < kFeet; ++foot) {
    if (!mode[foot]) feet[2 * foot] = 2.0 * speed_m_s;
  }
  set_joint_rates(*options.robot, feet, state);
  return state;
}

void fill_guess(Scene& scene) {
  const ocp::Horizon& horizon = scene.problem.horizon;
  scene.points.clear();
  for (int k = 0; k <= horizon.stages; ++k) {
    const bool end = k == horizon.stages;
    const ocp::Stage& stage = horizon.stage[static_cast<std::size_t>(std::min(k, horizon.stages - 1))];
    const gait::ReferencePoint point =
        scene.reference.evaluate(end ? horizon.end_s : stage.time_s, end ? horizon.end_phase : stage.phase);
    std::copy(scene.problem.x_initial, scene.problem.x_initial + lq::kRows, scene.guess.x[k]);
    scene.guess.x[k][0] += point.state[0] - scene.problem.x_initial[0];
    if (end) break;
    scene.points.push_back(point);
    const bool flow = stage.kind == ocp::StageKind::flow;
    for (int i = 0; i < kInputs; ++i) scene.guess.u[k][i] = flow ? point.input[i] : 0.0;
  }
}

}  // namespace

ocp::ProblemData default_data(const model::RobotModel& robot) {
  ocp::ProblemData data;
  data.robot = &robot;
  for (int j = 0; j < kJoints; ++j) {
    data.limits.position_min_rad[j] = robot.constants.position_min_rad[j];
    data.limits.position_max_rad[j] = robot.constants.position_max_rad[j];
    data.limits.velocity_rad_s[j] = robot.constants.velocity_limit_rad_s[j];
    data.limits.torque_Nm[j] = robot.constants.torque_limit_Nm[j];
  }
  std::ranges::copy(robot.constants.joint_parameters, data.joint_parameters);
  ocp::set_weights(data);
  return data;
}

std::unique_ptr<Scene> walking_scene(const SceneOptions& options) {
  auto scene = std::make_unique<Scene>();
  scene->data = default_data(*options.robot);
  scene->data.discretisation.horizon_s = options.horizon_s;
  scene->data.discretisation.integrator = options.integrator;
  scene->data.discretisation.transition = options.transition;
  const double beyond_s = 4.0 * (options.gait.single_support_s + options.gait.double_support_s);
  scene->schedule.reset(0.0);
  for (const double time_s : {0.0, options.time_s}) {
    scene->schedule.update(time_s, time_s + options.horizon_s + beyond_s, options.command, options.gait,
                           options.reference, options.command.speed_m_s, true);
  }
  const int phase = scene->schedule.index_at(options.time_s);
  const gait::ContactPhase& contact = scene->schedule.phase(phase);
  const double progress =
      (options.time_s - contact.start_s) / (scene->schedule.end_s(phase) - contact.start_s);
  const model::StateVector state = mid_stride(options, contact.mode, progress);
  model::KinematicsTerms<double> feet;
  options.robot->kinematics(state.data(), feet);
  scene->reference.prepare(options.robot->constants, scene->schedule, options.command, options.gait,
                           options.reference, options.time_s, state, model::FeetVector(feet.foot_position),
                           state[kPositions], 0.0);
  if (!ocp::build_horizon(scene->schedule, options.time_s, scene->data.discretisation,
                          scene->problem.horizon)) {
    throw std::invalid_argument("walking_scene: the horizon does not fit");
  }
  ocp::fill_batches(scene->reference, scene->problem);
  std::copy(state.data(), state.data() + kStates, scene->problem.x_initial);
  fill_guess(*scene);
  return scene;
}

std::unique_ptr<Scene> random_scene(const model::RobotModel& robot, model::ContactMode mode, int stages,
                                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  auto scene = std::make_unique<Scene>();
  scene->data = default_data(robot);
  if (seed % 3 != 0) {  // a torque-speed line, which the shipped robots' defaults do not have
    for (double& slope : scene->data.limits.torque_speed_slope_Nms_rad) slope = 10.0 + 5.0 * uniform(random);
  }
  ocp::Problem& problem = scene->problem;
  problem.horizon.stages = stages;
  scene->points.resize(static_cast<std::size_t>(stages));
  double time_s = 0.0;
  for (int k = 0; k < stages; ++k) {
    ocp::Stage& stage = problem.horizon.stage[static_cast<std::size_t>(k)];
    stage = {.time_s = time_s, .duration_s = 0.015 + 0.01 * uniform(random), .mode = mode};
    time_s += stage.duration_s;
    gait::ReferencePoint& point = scene->points[static_cast<std::size_t>(k)];
    for (double& value : point.state) value = 0.3 * uniform(random);
    for (double& value : point.input) value = 100.0 * uniform(random);
    for (double& value : point.foot_position_W_m) value = uniform(random);
    for (double& value : point.foot_velocity_W_m_s) value = uniform(random);
    for (double& value : point.foot_acceleration_W_m_s2) value = 10.0 * uniform(random);

    const int lane = k % ocp::kLanes;
    if (lane == 0) problem.batches = k / ocp::kLanes + 1;
    ocp::StageBatch& batch = problem.batch[problem.batches - 1];
    batch.mode = mode;
    batch.lanes = lane + 1;
    problem.place[k] = {problem.batches - 1, (mode.left ? 1 : 0) + (mode.right ? 2 : 0), lane};
    // The last stage also fills the lanes that stay unused.
    for (int fill = lane; fill < ocp::kLanes; ++fill) {
      batch.stage[fill] = k;
      batch.weight[fill] = fill == lane ? 1.0 : 0.0;
      batch.duration[fill] = stage.duration_s;
      for (int i = 0; i < kStates; ++i) batch.x_ref[i][fill] = point.state[i];
      for (int i = 0; i < kInputs; ++i) batch.u_ref[i][fill] = point.input[i];
      for (int i = 0; i < 2 * kFeet; ++i) {
        batch.foot_position_ref[i][fill] = point.foot_position_W_m[i];
        batch.foot_velocity_ref[i][fill] = point.foot_velocity_W_m_s[i];
        batch.foot_acceleration_ref[i][fill] = point.foot_acceleration_W_m_s2[i];
      }
    }
  }
  problem.horizon.end_s = time_s;
  for (int i = 0; i < kStates; ++i) problem.x_ref_terminal[i] = 0.3 * uniform(random);

  scene->guess = ocp::Trajectory{};
  for (int k = 0; k <= stages; ++k) {
    double* x = scene->guess.x[k];
    for (int i = 0; i < kStates; ++i) x[i] = (i < kPositions ? 0.6 : 4.0) * uniform(random);
    x[1] += 0.8;
    for (const int knee : {4, 6}) x[knee] = 1.0 + x[knee];
    if (k == stages) break;
    for (int i = 0; i < kInputs; ++i) scene->guess.u[k][i] = (i < kJoints ? 30.0 : 150.0) * uniform(random);
  }
  std::copy(scene->guess.x[0], scene->guess.x[0] + kStates, problem.x_initial);
  return scene;
}

void disturb(ocp::Trajectory& iterate, int stages, double size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k <= stages; ++k) {
    for (int i = 0; i < kStates; ++i) iterate.x[k][i] += size * uniform(random);
    if (k == stages) break;
    for (int i = 0; i < kInputs; ++i) iterate.u[k][i] += (i < kJoints ? size : 10.0 * size) * uniform(random);
  }
}

Eigen::Matrix<double, model::kInputs, model::kStates> inputs_by_state(
    const LqStage& stage, const ocp::InputProjection& projection) {
  using InputColumn = Eigen::Map<const model::InputVector>;
  using StateRow = Eigen::Map<const Eigen::Matrix<double, 1, model::kStates>>;
  Eigen::Matrix<double, model::kInputs, model::kStates> X;
  X.setZero();
  for (int r = 0; r < stage.constraints; ++r) {
    X += InputColumn(projection.Y[r]) * StateRow(stage.G[lq::kBaseRows + r]);
  }
  if (projection.first_force >= 0) {
    for (int axis = 0; axis < 2; ++axis) X.row(projection.first_force + axis) += StateRow(projection.F[axis]);
  }
  return X;
}

Eigen::Matrix<double, model::kInputs, Eigen::Dynamic> inputs_by_free(const LqStage& stage,
                                                                     const ocp::InputProjection& projection) {
  return Eigen::Map<const Eigen::Matrix<double, model::kInputs, Eigen::Dynamic>>(
      &projection.W[0][0], model::kInputs, stage.free_inputs);
}

}  // namespace stilt::testing_support
