#pragma once

#include <gtest/gtest.h>

#include "firmware/supervisor/supervisor.h"
#include "tests/firmware/supervisor/observations.h"

namespace stilt::supervisor::testing {

/// A supervisor, its parameters, and the inputs of the next tick: healthy until a test spoils them.
class SupervisorTest : public ::testing::Test {
 protected:
  SupervisorTest() {
    power_on();
    wanted_.fill({.position_rad = 0.3,
                  .velocity_rad_s = 0,
                  .torque_Nm = 30,
                  .kp_Nm_rad = 0,
                  .kd_Nms_rad = 0,
                  .torque_limit_Nm = 80});
  }

  /// A new start: boot, nothing asked for, nothing out of order.
  void power_on() {
    supervisor_.configure(joint_limits(), parameters_);
    inputs_ = {};
    inputs_.seen = healthy();
  }

  State tick() {
    inputs_.seen.time_ns += kTick_ns;
    supervisor_.update(inputs_);
    commands_.fill({});
    action_ = supervisor_.bound(wanted_, commands_);
    return output().state;
  }
  State run(double duration_s) {
    for (double time_s = 0; time_s < duration_s - 1e-9; time_s += 1e-3) tick();
    return output().state;
  }
  void request(RequestKind kind, double speed_m_s = 0) {
    inputs_.request = {kind, inputs_.request.number + 1, speed_m_s};
  }
  void bring_to_ready() {
    tick();
    request(RequestKind::calibrate);
    tick();
    inputs_.bring_up_done = true;
    tick();
    run(0.1);
    ASSERT_EQ(output().state, State::ready);
  }
  /// As bring_to_ready(), then standing up is asked for in a pose that does not allow it.
  void ask_to_stand_where_it_cannot() {
    bring_to_ready();
    inputs_.fit_to_stand = false;
    request(RequestKind::stand);
    run(1.0);
  }
  void bring_to_stand() {
    bring_to_ready();
    request(RequestKind::stand);
    run(parameters_.stand_ramp_s + 0.01);
    ASSERT_EQ(output().state, State::stand);
  }
  void bring_to_walk() {
    bring_to_stand();
    request(RequestKind::walk, 0.5);
    tick();
    ASSERT_EQ(output().state, State::walk);
  }
  const SupervisorOutput& output() const { return supervisor_.output(); }

  /// All four commands only damp.
  bool only_damps() const {
    if (action_ != Action::commands) return false;
    for (const hal::JointCommand& command : commands_) {
      if (command.kp_Nm_rad != 0 || command.torque_Nm != 0 || command.velocity_rad_s != 0) return false;
      if (!(command.kd_Nms_rad >= 0)) return false;
    }
    return true;
  }

  SupervisorParameters parameters_;
  Supervisor supervisor_;
  SupervisorInputs inputs_;
  hal::JointCommands wanted_;
  hal::JointCommands commands_;
  Action action_ = Action::silent;
};

}  // namespace stilt::supervisor::testing
