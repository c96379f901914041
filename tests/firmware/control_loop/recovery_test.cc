// Fault x protocol x state: the cause comes, the robot is damped or left alone, the cause goes, a reset, and
// it stands again without a restart.
#include <functional>
#include <string_view>
#include <vector>

#include "tests/firmware/control_loop/recovery_rig.h"

namespace stilt::control_loop {
namespace {

using configuration::DriverProtocol;
using hal::DriverFault;
using supervisor::State;
using testing::RecoveryRig;

constexpr DriverProtocol kProtocols[] = {DriverProtocol::mit_mini_cheetah, DriverProtocol::mit_ak,
                                         DriverProtocol::mit_damiao, DriverProtocol::moteus,
                                         DriverProtocol::odrive};
constexpr const char* kProtocolNames[] = {"mit_mini_cheetah", "mit_ak", "mit_damiao", "moteus", "odrive"};

/// What goes wrong with a joint, or its bus, and how it comes right.
struct Cause {
  const char* name;
  void (*begin)(RecoveryRig&, std::size_t joint);
  void (*end)(RecoveryRig&, std::size_t joint);
  bool needs_reports;  ///< of the driver: a mini-cheetah reports no fault
};

constexpr auto kNothing = [](RecoveryRig&, std::size_t) {};

const std::vector<Cause> kCauses = {
    {"over_current",
     [](RecoveryRig& rig, std::size_t joint) { rig.driver(joint).raise(DriverFault::over_current); },
     kNothing, true},
    {"encoder", [](RecoveryRig& rig, std::size_t joint) { rig.driver(joint).raise(DriverFault::encoder); },
     kNothing, true},
    {"power",
     [](RecoveryRig& rig, std::size_t joint) {
       rig.driver(joint).power_cycle();
       rig.driver(joint).set_powered(false);
     },
     [](RecoveryRig& rig, std::size_t joint) { rig.driver(joint).set_powered(true); }, false},
    {"stall", [](RecoveryRig& rig, std::size_t) { rig.sleep(150'000'000); }, kNothing, false},
    {"bus_off",
     [](RecoveryRig& rig, std::size_t joint) { rig.bus(joint / 2).set_health(hal::BusHealth::off); },
     kNothing, false},
    {"bus_gone", [](RecoveryRig& rig, std::size_t joint) { rig.set_gone(joint / 2, true); },
     [](RecoveryRig& rig, std::size_t joint) { rig.set_gone(joint / 2, false); }, false},
    {"emergency_stop", [](RecoveryRig& rig, std::size_t) { rig.press_emergency_stop(true); },
     [](RecoveryRig& rig, std::size_t) { rig.press_emergency_stop(false); }, false},
};

/// How a rig gets into the state in which the cause comes.
struct Moment {
  const char* name;
  std::function<bool(RecoveryRig&)> enter;
};

const std::vector<Moment> kMoments = {
    {"idle", [](RecoveryRig& rig) { return rig.reach(State::idle, 100); }},
    {"calibrate",
     [](RecoveryRig& rig) {
       rig.run(3);
       rig.ask(supervisor::RequestKind::calibrate);
       rig.run(3);
       return rig.state() == State::calibrate;
     }},
    {"ready",
     [](RecoveryRig& rig) {
       rig.run(3);
       const bool ready = rig.get_ready();
       rig.run(100);
       return ready;
     }},
    {"ramp",
     [](RecoveryRig& rig) {
       rig.run(3);
       if (!rig.get_ready()) return false;
       rig.run(80);
       rig.ask(supervisor::RequestKind::stand);
       rig.run(100);
       return rig.state() == State::stand && rig.decision().ramp < 1;
     }},
    {"stand",
     [](RecoveryRig& rig) {
       rig.run(3);
       return rig.stand();
     }},
    {"sit",
     [](RecoveryRig& rig) {
       rig.run(3);
       if (!rig.stand()) return false;
       rig.ask(supervisor::RequestKind::sit);
       return rig.reach(State::sit, 3000);
     }},
    {"fault",
     [](RecoveryRig& rig) {
       rig.run(3);
       if (!rig.stand()) return false;
       rig.press_emergency_stop(true);
       rig.run(50);
       return rig.state() == State::fault;
     }},
    {"resetting",
     [](RecoveryRig& rig) {
       rig.run(3);
       if (!rig.stand()) return false;
       rig.press_emergency_stop(true);
       rig.run(50);
       rig.ask(supervisor::RequestKind::reset);
       rig.run(100);
       return rig.state() == State::fault;
     }},
};

class Recovery : public ::testing::Test {
 protected:
  /// Whether the case makes sense; it fails where the robot does not come back.
  void expect_to_recover(std::size_t protocol, const Cause& cause, const Moment& moment, std::size_t joint) {
    if (cause.needs_reports && kProtocols[protocol] == DriverProtocol::mit_mini_cheetah) return;
    SCOPED_TRACE(std::string(kProtocolNames[protocol]) + ", " + cause.name + " in " + moment.name +
                 ", joint " + std::to_string(joint));
    auto rig = std::make_unique<RecoveryRig>(kProtocols[protocol]);
    ASSERT_TRUE(moment.enter(*rig)) << supervisor::name(rig->state());
    const bool was_up = rig->state() != State::idle && rig->state() != State::calibrate;
    // Without a watchdog a driver follows its last command as long as no other arrives.
    const bool unwatched = kProtocols[protocol] < DriverProtocol::mit_damiao;
    const bool drives_on = unwatched && std::string_view(cause.name).starts_with("bus");
    cause.begin(*rig, joint);
    rig->run(40);
    if (was_up) {
      ASSERT_EQ(rig->state(), State::fault);
      ASSERT_TRUE(drives_on || rig->largest_torque_Nm() <= 0.1) << "damped at rest";
    }
    ASSERT_FALSE(supervisor::tracks(rig->state()));
    cause.end(*rig, joint);
    rig->press_emergency_stop(false);
    rig->run(40);
    if (rig->state() == State::idle) {
      ASSERT_TRUE(rig->stand()) << supervisor::name(rig->state());
    } else if (rig->state() == State::calibrate || rig->state() == State::ready) {
      ASSERT_TRUE(rig->reach(State::ready, 2000))
          << "bring-up gets over it: " << supervisor::name(rig->state());
    } else {
      ASSERT_TRUE(rig->recover()) << supervisor::name(rig->state()) << ", latched "
                                  << rig->decision().latched.bits() << ", present "
                                  << rig->decision().present.bits();
    }
    EXPECT_TRUE(rig->all_enabled());
    ++cases_;
  }
  int cases_ = 0;
};

TEST_F(Recovery, OfASampleOfCasesEachEndsStandingAgain) {
  std::size_t number = 0;
  for (std::size_t protocol = 0; protocol < std::size(kProtocols); ++protocol) {
    for (const Cause& cause : kCauses) {
      for (const Moment& moment : kMoments) {
        if (number++ % 5 == 0) expect_to_recover(protocol, cause, moment, number % hal::kJoints);
      }
    }
  }
  EXPECT_GE(cases_, 45);
}

// All of them: recovery_test --gtest_also_run_disabled_tests --gtest_filter='*OfEveryCase'
TEST_F(Recovery, DISABLED_OfEveryCase) {
  for (std::size_t protocol = 0; protocol < std::size(kProtocols); ++protocol) {
    for (const Cause& cause : kCauses) {
      for (const Moment& moment : kMoments) {
        for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
          expect_to_recover(protocol, cause, moment, joint);
        }
      }
    }
  }
  EXPECT_GE(cases_, 1000);
}

TEST_F(Recovery, TheEmergencyStopPressedAtTheStartEnergisesNoDriver) {
  for (const DriverProtocol protocol : kProtocols) {
    auto rig = std::make_unique<RecoveryRig>(protocol);
    rig->press_emergency_stop(true);
    for (int i = 0; i < 1500; ++i) {
      rig->tick();
      for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
        ASSERT_FALSE(rig->driver(joint).enabled()) << joint;
      }
    }
    EXPECT_EQ(rig->state(), State::fault);
    rig->press_emergency_stop(false);
    EXPECT_TRUE(rig->recover()) << supervisor::name(rig->state());
  }
}

TEST_F(Recovery, ARejectedResetLeavesTheOtherJointsDamped) {
  for (const DriverProtocol protocol : kProtocols) {
    auto rig = std::make_unique<RecoveryRig>(protocol);
    rig->run(3);
    ASSERT_TRUE(rig->stand());
    rig->driver(1).set_powered(false);
    rig->run(50);
    ASSERT_EQ(rig->state(), State::fault);
    rig->ask(supervisor::RequestKind::reset);
    for (int i = 0; i < 1000; ++i) {
      rig->tick();
      for (const std::size_t joint : {0u, 2u, 3u}) ASSERT_TRUE(rig->driver(joint).enabled()) << i;
    }
    EXPECT_EQ(rig->state(), State::fault) << "its cause is there";
  }
}

}  // namespace
}  // namespace stilt::control_loop
