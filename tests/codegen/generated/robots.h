#pragma once

#include <complex>

/// Sine and cosine of complex numbers, so that generated functions can be differentiated by complex step.
/// Must be declared before the generated headers.
namespace stilt::runtime {
inline void sincos(const std::complex<double>& angle, std::complex<double>& sine,
                   std::complex<double>& cosine) noexcept {
  sine = std::sin(angle);
  cosine = std::cos(angle);
}
}  // namespace stilt::runtime

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "codegen/generated/amber3m/constants.h"
#include "codegen/generated/amber3m/impact.h"
#include "codegen/generated/amber3m/kinematics.h"
#include "codegen/generated/amber3m/node.h"
#include "codegen/generated/rabbit/constants.h"
#include "codegen/generated/rabbit/impact.h"
#include "codegen/generated/rabbit/kinematics.h"
#include "codegen/generated/rabbit/node.h"
#include "mpc_core/model/terms.h"

/// Both generated robots behind one interface for typed tests.
namespace stilt::testing_support {

/// Every generated function with the structs it writes; `robot` is a namespace in stilt::generated.
#define STILT_TEST_ROBOT(Type, robot)                                                         \
  struct Type {                                                                               \
    static constexpr const char* kName = generated::robot::kRobotName;                        \
    static constexpr const double* kJointParameters = generated::robot::kJointParameters;     \
    template <class T>                                                                        \
    static model::MassMatrixTerms<T> mass_matrix(const T* x, const T* p) {                    \
      model::MassMatrixTerms<T> out;                                                          \
      generated::robot::mass_matrix(x, p, out);                                               \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::BiasTerms<T> bias(const T* x) {                                             \
      model::BiasTerms<T> out;                                                                \
      generated::robot::bias(x, out);                                                         \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::KinematicsTerms<T> kinematics(const T* x) {                                 \
      model::KinematicsTerms<T> out;                                                          \
      generated::robot::kinematics(x, out);                                                   \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::FlowTerms<T> flow(const T* x, const T* u) {                                 \
      model::FlowTerms<T> out;                                                                \
      generated::robot::flow(x, u, out);                                                      \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::FlowDerivatives<T> flow_derivatives(const T* x, const T* u) {               \
      model::FlowDerivatives<T> out;                                                          \
      generated::robot::flow_derivatives(x, u, out);                                          \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::NodeTerms<T> node(const T* x, const T* u, const T* p) {                     \
      model::NodeTerms<T> out;                                                                \
      generated::robot::node(x, u, p, out);                                                   \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::NodeDerivatives<T> node_derivatives(const T* x, const T* u, const T* p) {   \
      model::NodeDerivatives<T> out;                                                          \
      generated::robot::node_derivatives(x, u, p, out);                                       \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::ImpactTerms<T> impact(int foot, const T* x, const T* p) {                   \
      model::ImpactTerms<T> out;                                                              \
      foot == model::kLeft ? generated::robot::impact_left(x, p, out)                         \
                           : generated::robot::impact_right(x, p, out);                       \
      return out;                                                                             \
    }                                                                                         \
    template <class T>                                                                        \
    static model::ImpactDerivatives<T> impact_derivatives(int foot, const T* x, const T* p) { \
      model::ImpactDerivatives<T> out;                                                        \
      foot == model::kLeft ? generated::robot::impact_left_derivatives(x, p, out)             \
                           : generated::robot::impact_right_derivatives(x, p, out);           \
      return out;                                                                             \
    }                                                                                         \
  }

STILT_TEST_ROBOT(Amber3m, amber3m);
STILT_TEST_ROBOT(Rabbit, rabbit);
#undef STILT_TEST_ROBOT

using Robots = testing::Types<Amber3m, Rabbit>;

/// A random state, input and set of joint parameters, far wider than walking needs.
struct Sample {
  std::array<double, model::kStates> x;
  std::array<double, model::kInputs> u;
  std::array<double, 2 * model::kJoints> p;

  explicit Sample(std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < model::kStates; ++i) {
      x[static_cast<std::size_t>(i)] = (i < model::kPositions ? 2.0 : 8.0) * uniform(random);
    }
    for (int i = 0; i < model::kInputs; ++i) {
      u[static_cast<std::size_t>(i)] = (i < model::kJoints ? 50.0 : 300.0) * uniform(random);
    }
    for (int i = 0; i < 2 * model::kJoints; ++i) {
      p[static_cast<std::size_t>(i)] = (i < model::kJoints ? 0.5 : 2.0) * (1.0 + uniform(random));
    }
  }
};

}  // namespace stilt::testing_support
