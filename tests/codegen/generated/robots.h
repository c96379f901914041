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

#include "codegen/generated/five_link/impact.h"
#include "codegen/generated/five_link/kinematics.h"
#include "codegen/generated/five_link/node.h"
#include "mpc_core/model/leg_exchange.h"
#include "tests/robots.h"

/// The generated functions of a robot over any scalar: double, batches of any width, complex numbers.
namespace stilt::testing_support {

class AnyScalarRobot {
 public:
  explicit AnyScalarRobot(const model::RobotModel& robot) : robot_(robot) {}

  template <class T>
  model::MassMatrixTerms<T> mass_matrix(const T* x, const T* p) const {
    model::MassMatrixTerms<T> out;
    generated::five_link::mass_matrix(x, p, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::BiasTerms<T> bias(const T* x) const {
    model::BiasTerms<T> out;
    generated::five_link::bias(x, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::KinematicsTerms<T> kinematics(const T* x) const {
    model::KinematicsTerms<T> out;
    generated::five_link::kinematics(x, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::FlowTerms<T> flow(const T* x, const T* u) const {
    model::FlowTerms<T> out;
    generated::five_link::flow(x, u, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::FlowDerivatives<T> flow_derivatives(const T* x, const T* u) const {
    model::FlowDerivatives<T> out;
    generated::five_link::flow_derivatives(x, u, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::NodeTerms<T> node(const T* x, const T* u, const T* p) const {
    model::NodeTerms<T> out;
    generated::five_link::node(x, u, p, coefficients<T>().data(), out);
    return out;
  }
  template <class T>
  model::NodeDerivatives<T> node_derivatives(const T* x, const T* u, const T* p) const {
    model::NodeDerivatives<T> out;
    generated::five_link::node_derivatives(x, u, p, coefficients<T>().data(), out);
    return out;
  }
  /// `contact` has at least one foot.
  template <class T>
  model::ImpactTerms<T> impact(model::ContactMode contact, const T* x, const T* p) const {
    return in_mode<model::ImpactTerms<T>>(
        contact, x, p, [](auto&&... arguments) { generated::five_link::impact_left(arguments...); },
        [](auto&&... arguments) { generated::five_link::impact_both(arguments...); });
  }
  template <class T>
  model::ImpactDerivatives<T> impact_derivatives(model::ContactMode contact, const T* x, const T* p) const {
    return in_mode<model::ImpactDerivatives<T>>(
        contact, x, p,
        [](auto&&... arguments) { generated::five_link::impact_left_derivatives(arguments...); },
        [](auto&&... arguments) { generated::five_link::impact_both_derivatives(arguments...); });
  }

 private:
  template <class T>
  std::array<T, generated::five_link::kCoefficientCount> coefficients() const {
    std::array<T, generated::five_link::kCoefficientCount> values;
    std::ranges::copy(robot_.coefficients.coefficient, values.begin());
    return values;
  }

  template <class Terms, class T, class Left, class Both>
  Terms in_mode(model::ContactMode contact, const T* x, const T* p, const Left& left_foot,
                const Both& both_feet) const {
    const auto k = coefficients<T>();
    Terms terms{};
    if (contact.count() == 2) {
      both_feet(x, p, k.data(), terms);
    } else if (contact.left) {
      left_foot(x, p, k.data(), terms);
    } else {
      const model::ExchangedArguments<T> mirrored(x, p);
      Terms left{};
      left_foot(mirrored.x, mirrored.p, k.data(), left);
      model::exchange_legs(left, terms);
    }
    return terms;
  }

  const model::RobotModel& robot_;
};

/// One robot as a type, for typed tests.
template <const model::RobotModel& (*Robot)()>
struct GeneratedRobot {
  static const char* name() { return Robot().constants.name; }
  static const double* joint_parameters() { return Robot().constants.joint_parameters; }
  static AnyScalarRobot robot() { return AnyScalarRobot(Robot()); }
  static auto mass_matrix(const auto* x, const auto* p) { return robot().mass_matrix(x, p); }
  static auto bias(const auto* x) { return robot().bias(x); }
  static auto kinematics(const auto* x) { return robot().kinematics(x); }
  static auto flow(const auto* x, const auto* u) { return robot().flow(x, u); }
  static auto flow_derivatives(const auto* x, const auto* u) { return robot().flow_derivatives(x, u); }
  static auto node(const auto* x, const auto* u, const auto* p) { return robot().node(x, u, p); }
  static auto node_derivatives(const auto* x, const auto* u, const auto* p) {
    return robot().node_derivatives(x, u, p);
  }
  static auto impact(model::ContactMode contact, const auto* x, const auto* p) {
    return robot().impact(contact, x, p);
  }
  static auto impact_derivatives(model::ContactMode contact, const auto* x, const auto* p) {
    return robot().impact_derivatives(contact, x, p);
  }
};

/// The contact modes in which an impact can end.
inline constexpr std::array<model::ContactMode, 3> kLandings{
    {{.left = true, .right = false}, {.left = false, .right = true}, {.left = true, .right = true}}};

using Amber3m = GeneratedRobot<amber3m>;
using Rabbit = GeneratedRobot<rabbit>;

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
