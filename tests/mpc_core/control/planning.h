#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "firmware/configuration/configuration.h"
#include "mpc_core/control/planner.h"
#include "mpc_core/control/torque_law.h"
#include "tests/mpc_core/printers.h"
#include "tests/robots.h"

/// A planner on its own, without sensors, torque loop or simulator.
namespace stilt::testing_support {

using control::ConfigureStatus;
using control::ControllerParameters;
using control::Plan;
using control::Planner;
using gait::GaitCommand;
using gait::GaitKind;
using model::StateVector;
using sqp::SolveReport;

inline constexpr double kPeriod_s = 0.01;
inline constexpr GaitCommand kStand{GaitKind::stand, 0.0};
inline constexpr GaitCommand kWalk{GaitKind::walk, 0.5};

inline ControllerParameters shipped() { return configuration::load_robot("amber3m").value(); }

/// No plan is refused as infeasible, for plans that are not solved to the end.
inline ControllerParameters with_every_plan(ControllerParameters parameters) {
  parameters.sqp.plan_defect_max = 1e6;
  parameters.sqp.plan_cone_violation_max_N = 1e6;
  parameters.sqp.plan_pulling_force_max_N = 1e6;
  return parameters;
}

/// A planner and the plan it fills, on the heap for their size.
struct Planning {
  explicit Planning(const ControllerParameters& chosen) : parameters(chosen) {
    status = planner->configure(testing_support::amber3m(), parameters);
    planner->reset(0.0);
    state =
        gait::standing_state(testing_support::amber3m().constants, parameters.reference.base_height_m,
                             parameters.reference.base_pitch_rad, parameters.gait.stand_half_width_m, true);
  }

  SolveReport solve(const GaitCommand& command) { return planner->plan({time_s, state, command}, *plan); }

  /// The robot goes exactly where the plan has it, for one period of the planner.
  void follow() {
    time_s += kPeriod_s;
    state = control::interpolate(*plan, time_s).state;
  }

  void advance(const GaitCommand& command, int cycles) {
    for (int i = 0; i < cycles; ++i) {
      ASSERT_TRUE(solve(command).usable()) << "cycle " << i;
      follow();
    }
  }

  ControllerParameters parameters;
  ConfigureStatus status = ConfigureStatus::ok;
  std::unique_ptr<Planner> planner = std::make_unique<Planner>();
  std::unique_ptr<Plan> plan = std::make_unique<Plan>();
  StateVector state;
  double time_s = 0.0;
};

}  // namespace stilt::testing_support
