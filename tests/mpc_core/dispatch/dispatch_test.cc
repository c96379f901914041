#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <memory>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/configuration/configuration.h"
#include "mpc_core/control/plan.h"
#include "mpc_core/dispatch/dispatched_planner.h"
#include "mpc_core/gait/reference.h"
#include "tests/robots.h"
#include "tests/used_memory.h"

/// The planners for several instruction sets in one program: the same problem has the same optimum in each.
namespace stilt::dispatch {
namespace {

using control::ConfigureStatus;
using control::ControllerParameters;
using control::Plan;
using gait::GaitCommand;
using gait::GaitKind;
using model::InstructionSet;

constexpr double kPeriod_s = 0.01;
constexpr GaitCommand kWalk{GaitKind::walk, 0.5};

std::vector<InstructionSet> sets_here() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set :
       {InstructionSet::sse2, InstructionSet::avx2, InstructionSet::avx512, InstructionSet::neon}) {
    if (available(set)) sets.push_back(set);
  }
  return sets;
}

ControllerParameters parameters_for(InstructionSet set) {
  ControllerParameters parameters = configuration::load_robot("amber3m").value();
  parameters.sqp.instruction_set = set;
  return parameters;
}

model::StateVector standing() {
  const ControllerParameters p = parameters_for(InstructionSet::automatic);
  return gait::standing_state(testing_support::amber3m().constants, p.reference.base_height_m,
                              p.reference.base_pitch_rad, p.gait.stand_half_width_m, true);
}

static_assert(std::is_trivially_destructible_v<DispatchedPlanner>);

/// Room for a planner.
struct alignas(DispatchedPlanner) Memory {
  std::byte bytes[sizeof(DispatchedPlanner)];
};

/// A planner and its plan, on the heap for their size.
struct Planning {
  explicit Planning(const ControllerParameters& parameters)
      : own(std::make_unique<DispatchedPlanner>()), dispatched(own.get()) {
    begin(parameters);
  }
  /// Of a planner that is elsewhere, and outlives this.
  Planning(DispatchedPlanner& planner, const ControllerParameters& parameters) : dispatched(&planner) {
    begin(parameters);
  }

  void begin(const ControllerParameters& parameters) {
    EXPECT_EQ(dispatched->configure(testing_support::amber3m(), parameters), ConfigureStatus::ok);
    dispatched->planner().reset(0.0);
  }

  sqp::SolveReport plan_from(double time_s, const model::StateVector& state) {
    return dispatched->planner().plan({time_s, state, kWalk}, *plan);
  }

  std::unique_ptr<DispatchedPlanner> own;
  DispatchedPlanner* dispatched;
  std::unique_ptr<Plan> plan = std::make_unique<Plan>();
};

/// Numbers of a walk that follows its own plans, for comparing bits.
std::vector<double> walk(Planning& planning, int cycles) {
  std::vector<double> numbers;
  model::StateVector state = standing();
  for (int i = 0; i < cycles; ++i) {
    EXPECT_TRUE(planning.plan_from(i * kPeriod_s, state).usable()) << "cycle " << i;
    state = control::interpolate(*planning.plan, (i + 1) * kPeriod_s).state;
    numbers.insert(numbers.end(), state.begin(), state.end());
  }
  return numbers;
}

TEST(Dispatch, KernelsShareTheLayoutOfTheTypesThatPassThrough) {
  EXPECT_EQ(stilt_planner_kernel.layout, layout());
#ifdef STILT_AVX512_KERNEL
  EXPECT_EQ(stilt_planner_kernel_avx512.layout, layout());
  EXPECT_EQ(stilt_planner_kernel_avx512.instruction_set, InstructionSet::avx512);
#endif
}

/// Each kernel asserts at compile time that its planner fits the room in a DispatchedPlanner.
TEST(Dispatch, ThePlannerOfEverySetFitsTwoMebibytes) {
  EXPECT_LE(sizeof(DispatchedPlanner), 2U * 1024U * 1024U);
}

class EverySet : public ::testing::TestWithParam<InstructionSet> {};

TEST_P(EverySet, FindsTheSameOptimumAlongAWalk) {
  constexpr int kCycles = 80;  // from standing into the second step
  constexpr double kSame = 1e-6;
  const auto converged = [](InstructionSet set) {
    ControllerParameters parameters = parameters_for(set);
    parameters.sqp.iterations = 40;
    parameters.sqp.cost_tolerance = 1e-12;
    parameters.sqp.step_tolerance = 1e-10;
    // Full steps: near the optimum rounding of the cost decides whether a line search accepts one.
    parameters.sqp.filter_violation_min = parameters.sqp.filter_violation_max = 1e12;
    parameters.sqp.armijo = -1e12;
    return parameters;
  };
  Planning reference(converged(instruction_set_of_build()));
  Planning planning(converged(GetParam()));
  ASSERT_EQ(planning.dispatched->instruction_set(), GetParam());
  model::StateVector state = standing();
  for (int i = 0; i < kCycles; ++i) {
    const double time_s = i * kPeriod_s;
    ASSERT_TRUE(reference.plan_from(time_s, state).usable()) << "cycle " << i;
    ASSERT_TRUE(planning.plan_from(time_s, state).usable()) << "cycle " << i;
    ASSERT_EQ(planning.plan->nodes, reference.plan->nodes) << "cycle " << i;
    for (int k = 0; k < reference.plan->nodes; ++k) {
      const control::PlanNode& expected = reference.plan->node[static_cast<std::size_t>(k)];
      const control::PlanNode& node = planning.plan->node[static_cast<std::size_t>(k)];
      ASSERT_EQ(node.time_s, expected.time_s);
      ASSERT_LT((node.state - expected.state).cwiseAbs().maxCoeff(), kSame)
          << "cycle " << i << ", node " << k;
    }
    state = control::interpolate(*reference.plan, time_s + kPeriod_s).state;
  }
}

TEST_P(EverySet, GivesTheSameBitsEachTimeAndAfterAnotherSet) {
  constexpr int kCycles = 20;
  Planning planning(parameters_for(GetParam()));
  const std::vector<double> first = walk(planning, kCycles);
  for (const InstructionSet other : sets_here()) planning.begin(parameters_for(other));
  planning.begin(parameters_for(GetParam()));
  EXPECT_EQ(walk(planning, kCycles), first);
}

/// Controllers are made in memory of all kinds. A planner that reads what it has not written plans by chance.
TEST_P(EverySet, PlansTheSameBitsWhateverItsMemoryHeld) {
  constexpr int kCycles = 80;  // single and double support, and a touch-down
  const auto bytes = std::make_unique<Memory>();
  const auto walk_in_memory_of = [&](unsigned char value) {
    testing_support::fill_memory(bytes.get(), sizeof *bytes, value);
    Planning planning(*new (bytes.get()) DispatchedPlanner, parameters_for(GetParam()));
    return walk(planning, kCycles);
  };
  const std::vector<double> zeroed = walk_in_memory_of(0);
  EXPECT_EQ(walk_in_memory_of(0xFF), zeroed) << "memory of NaN";
  EXPECT_EQ(walk_in_memory_of(0x5A), zeroed) << "memory of 1.8e127";
}

TEST_P(EverySet, IsWhatItIsAskedFor) {
  EXPECT_EQ(choose(GetParam()), GetParam());
  EXPECT_TRUE(available(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Here, EverySet, ::testing::ValuesIn(sets_here()),
                         [](const auto& set) { return std::string(model::name_of(set.param)); });

/// The family of an AMD processor as the kernel reports it; 0 for every other.
int amd_family() {
  std::ifstream file("/proc/cpuinfo");
  bool amd = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("vendor_id")) amd = line.ends_with("AuthenticAMD");
    if (amd && line.starts_with("cpu family")) return std::stoi(line.substr(line.find(':') + 1));
  }
  return 0;
}

TEST(Dispatch, AutomaticIsAvx512ExceptOnZen4) {
  constexpr int kFamilyOfZen4 = 0x19;
  const bool gains = available(InstructionSet::avx512) && amd_family() != kFamilyOfZen4;
  const InstructionSet expected = gains ? InstructionSet::avx512 : instruction_set_of_build();
  EXPECT_EQ(choose(InstructionSet::automatic), expected);
  EXPECT_TRUE(available(expected));
  EXPECT_EQ(std::make_unique<DispatchedPlanner>()->instruction_set(), expected);
}

TEST(Dispatch, RefusesAnInstructionSetOfAnotherFamily) {
  const bool arm = instruction_set_of_build() == InstructionSet::neon;
  const InstructionSet other = arm ? InstructionSet::avx2 : InstructionSet::neon;
  EXPECT_FALSE(choose(other).has_value());
  const auto planner = std::make_unique<DispatchedPlanner>();
  EXPECT_EQ(planner->configure(testing_support::amber3m(), parameters_for(other)),
            ConfigureStatus::no_such_instructions);
}

}  // namespace
}  // namespace stilt::dispatch
