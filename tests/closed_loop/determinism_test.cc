#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>

#include "tests/closed_loop/simulated_run.h"

/// A run depends on its settings and its seed alone.
namespace stilt::simulation {
namespace {

using testing_support::RunRequest;
using testing_support::SimulatedRun;

/// Walking with a push and sensor noise, so that everything is at work.
RunRequest eventful(std::uint64_t seed) {
  RunRequest request = testing_support::walking(0.5, 1.0, 6.0);
  request.plant = {"encoder_noise_rad=0.001", "encoder_velocity_noise_rad_s=0.05"};
  request.pushes = {{30.0, 3.0, 0.5, PushPoint::hip}};
  request.seed = seed;
  request.keep_samples = true;
  return request;
}

bool same_bits(const auto& a, const auto& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const log::RunSample& a, const log::RunSample& b) {
  return same_bits(a.true_state, b.true_state) && same_bits(a.estimated_state, b.estimated_state) &&
         same_bits(a.planned_state, b.planned_state) && same_bits(a.torque_Nm, b.torque_Nm) &&
         same_bits(a.contact_force_N, b.contact_force_N) &&
         same_bits(a.planned_contact_force_N, b.planned_contact_force_N);
}

bool same(const sqp::SolveReport& a, const sqp::SolveReport& b) {
  return a.status == b.status && a.iterations == b.iterations && same_bits(a.cost, b.cost) &&
         same_bits(a.dynamics_defect_max, b.dynamics_defect_max) &&
         same_bits(a.step_component_max, b.step_component_max) &&
         same_bits(a.equality_violation_max, b.equality_violation_max) &&
         same_bits(a.violations.friction_cone_violation_max_N, b.violations.friction_cone_violation_max_N) &&
         same_bits(a.violations.impulse_cone_violation_max_Ns, b.violations.impulse_cone_violation_max_Ns);
}

void expect_identical(const log::RunRecord& a, const log::RunRecord& b) {
  ASSERT_EQ(a.samples.size(), b.samples.size());
  ASSERT_EQ(a.solves.size(), b.solves.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_TRUE(same(a.samples[i], b.samples[i])) << "first difference at " << a.samples[i].time_s << " s";
  }
  for (std::size_t i = 0; i < a.solves.size(); ++i) {
    ASSERT_TRUE(same(a.solves[i].report, b.solves[i].report)) << "plan at " << a.solves[i].time_s << " s";
  }
}

TEST(Determinism, TwoRunsAreIdenticalBitForBit) {
  SimulatedRun first(eventful(7));
  SimulatedRun second(eventful(7));
  expect_identical(first.run(), second.run());
}

TEST(Determinism, AControllerUsedBeforeRepeatsTheRunOfANewOne) {
  SimulatedRun first(eventful(7));
  SimulatedRun second(eventful(7));
  SimulatedRun other(eventful(8));
  (void)run_closed_loop(other.plant, *second.controller, other.settings);
  expect_identical(first.run(), second.run());
}

TEST(Determinism, ASlowPlannerChangesNothing) {
  SimulatedRun first(eventful(7));
  SimulatedRun second(eventful(7));
  int turns = 0;
  second.settings.observer.plans = [&turns](double) {
    if (++turns % 600 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return true;
  };
  expect_identical(first.run(), second.run());
}

TEST(Determinism, AnotherSeedGivesAnotherRun) {
  SimulatedRun first(eventful(7));
  SimulatedRun second(eventful(8));
  const log::RunRecord a = first.run();
  const log::RunRecord b = second.run();
  ASSERT_FALSE(a.samples.empty() || b.samples.empty());
  EXPECT_FALSE(same(a.samples.back(), b.samples.back()));
}

}  // namespace
}  // namespace stilt::simulation
