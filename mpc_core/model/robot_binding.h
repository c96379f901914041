#pragma once

#include <algorithm>

#include "mpc_core/model/robot.h"

/// Binds the functions of one generated namespace to a RobotModel. Each robot has one small file that uses
/// it, so that the generated code is compiled once for double and once for batches.

// Macros, because a namespace cannot be a template argument.
// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define STILT_ROBOT_FUNCTIONS(robot, T)                                                                  \
  RobotFunctions<T> {                                                                                    \
    .flow = [](const T* x, const T* u, FlowTerms<T>& out) noexcept { robot::flow(x, u, out); },          \
    .flow_derivatives = [](const T* x, const T* u,                                                       \
                           FlowDerivatives<T>& out) noexcept { robot::flow_derivatives(x, u, out); },    \
    .node = [](const T* x, const T* u, const T* p,                                                       \
               NodeTerms<T>& out) noexcept { robot::node(x, u, p, out); },                               \
    .node_derivatives = [](const T* x, const T* u, const T* p,                                           \
                           NodeDerivatives<T>& out) noexcept { robot::node_derivatives(x, u, p, out); }, \
    .kinematics = [](const T* x, KinematicsTerms<T>& out) noexcept { robot::kinematics(x, out); },       \
    .impact = {                                                                                          \
        [](const T* x, const T* p, ImpactTerms<T>& out) noexcept { robot::impact_left(x, p, out); },     \
        [](const T* x, const T* p, ImpactTerms<T>& out) noexcept { robot::impact_right(x, p, out); }},   \
    .impact_derivatives = {[](const T* x, const T* p, ImpactDerivatives<T>& out) noexcept {              \
                             robot::impact_left_derivatives(x, p, out);                                  \
                           },                                                                            \
                           [](const T* x, const T* p, ImpactDerivatives<T>& out) noexcept {              \
                             robot::impact_right_derivatives(x, p, out);                                 \
                           }},                                                                           \
    .mass_matrix = [](const T* x, const T* p,                                                            \
                      MassMatrixTerms<T>& out) noexcept { robot::mass_matrix(x, p, out); },              \
    .bias = [](const T* x, BiasTerms<T>& out) noexcept { robot::bias(x, out); },                         \
  }

#define STILT_ROBOT_MODEL(robot)                                          \
  [] {                                                                    \
    RobotModel model{};                                                   \
    RobotConstants& c = model.constants;                                  \
    c.name = robot::kRobotName;                                           \
    c.total_mass_kg = robot::kMass_kg;                                    \
    c.thigh_length_m = robot::kThighLength_m;                             \
    c.shin_length_m = robot::kShinLength_m;                               \
    c.torso_com_height_m = robot::kBaseCom_m[1];                          \
    std::ranges::copy(robot::kPositionMin_rad, c.position_min_rad);       \
    std::ranges::copy(robot::kPositionMax_rad, c.position_max_rad);       \
    std::ranges::copy(robot::kVelocityMax_rad_s, c.velocity_limit_rad_s); \
    std::ranges::copy(robot::kTorqueMax_Nm, c.torque_limit_Nm);           \
    std::ranges::copy(robot::kJointParameters, c.joint_parameters);       \
    model.scalar = STILT_ROBOT_FUNCTIONS(robot, double);                  \
    model.batch = STILT_ROBOT_FUNCTIONS(robot, Batch);                    \
    return model;                                                         \
  }()
// NOLINTEND(cppcoreguidelines-macro-usage)
