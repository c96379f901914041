#include "firmware/supervisor/fault_detail.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/firmware/supervisor/observations.h"
#include "tests/firmware/supervisor/spoils.h"

namespace stilt::supervisor {
namespace {

using testing::healthy;
using testing::joint_limits;
using testing::kSpoils;
using testing::Spoil;

FaultDetail after(const Spoil& spoil) {
  Observation seen = healthy();
  spoil.apply(seen);
  return detail(spoil.fault, seen, joint_limits(), {});
}

TEST(FaultDetail, AValueHasCrossedItsLimitOneWayOrTheOther) {
  int with_limit = 0;
  for (const Spoil& spoil : kSpoils) {
    const FaultDetail found = after(spoil);
    if (std::isnan(found.limit)) continue;
    ++with_limit;
    const bool lower = spoil.fault == Fault::low_voltage || spoil.fault == Fault::hip_height_limit;
    EXPECT_TRUE(lower ? found.value < found.limit : std::abs(found.value) >= found.limit)
        << name(spoil.fault) << ": " << found.value << " against " << found.limit;
    EXPECT_STRNE(found.unit, "") << name(spoil.fault);
  }
  EXPECT_GE(with_limit, 21);
}

TEST(FaultDetail, TheJointIsTheOneThatIsSpoilt) {
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    Observation seen = healthy();
    seen.joints[joint].fault = hal::DriverFault::encoder;
    seen.joints[joint].fault_code = 0x2a;
    seen.joints[joint].motor_temperature_C = 96;
    seen.joints[joint].position_rad = -7;
    const auto of = [&](Fault fault) { return detail(fault, seen, joint_limits(), {}); };
    EXPECT_EQ(of(Fault::driver_fault).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::driver_fault).driver_fault, hal::DriverFault::encoder);
    EXPECT_EQ(of(Fault::driver_fault).fault_code, 0x2au);
    EXPECT_EQ(of(Fault::driver_overheated).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::driver_overheated).value, 96);
    EXPECT_EQ(of(Fault::driver_overheated).limit, SupervisorParameters{}.overheated_C);
    EXPECT_EQ(of(Fault::joint_position_limit).joint, static_cast<int>(joint));
    EXPECT_EQ(of(Fault::joint_position_limit).value, -7);
    EXPECT_LT(of(Fault::joint_position_limit).limit, 0.1);
  }
}

TEST(FaultDetail, TheLimitOfAMissingTorqueIsTheLargerOfTheTwo) {
  Observation seen = healthy();
  seen.signals.asked_torque_Nm[2] = 50;
  seen.signals.torque_mismatch_Nm[2] = -31;
  EXPECT_EQ(detail(Fault::torque_mismatch, seen, joint_limits(), {}).limit, 30);
  seen.signals.asked_torque_Nm[2] = 5;
  EXPECT_EQ(detail(Fault::torque_mismatch, seen, joint_limits(), {}).limit,
            SupervisorParameters{}.torque_mismatch_Nm);
}

}  // namespace
}  // namespace stilt::supervisor
