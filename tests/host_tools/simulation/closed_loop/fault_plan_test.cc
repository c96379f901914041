#include "host_tools/simulation/closed_loop/fault_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace stilt::simulation {
namespace {

TEST(FaultPlan, EveryFaultOfTheTableIsReadByItsName) {
  for (const FaultDescription& row : fault_table()) {
    const TimedFault fault = parse_fault(std::string(row.name) + "@2.5");
    EXPECT_EQ(fault.kind, row.kind);
    EXPECT_EQ(fault.start_s, 2.5);
    EXPECT_EQ(fault.duration_s, row.default_duration_s);
    EXPECT_STREQ(describe(row.kind).name, row.name);
    EXPECT_NE(describe_faults(FaultsOf::robot_on_buses).find(row.name), std::string::npos);
  }
}

TEST(FaultPlan, TargetAndDurationAreRead) {
  const TimedFault frames = parse_fault("drop:hip_R@5+0.1");
  EXPECT_EQ(frames.joint, 2u);
  EXPECT_FALSE(frames.bus);
  EXPECT_EQ(frames.duration_s, 0.1);
  EXPECT_EQ(parse_fault("bus-off:1@5").bus, 1u);
  EXPECT_EQ(parse_fault("drop:0@5").bus, 0u);
}

TEST(FaultPlan, FaultsOfOneThingHaveATargetOfTheirOwn) {
  EXPECT_EQ(parse_fault("driver-fault@1").joint, 1u);
  EXPECT_EQ(parse_fault("bus-off@1").bus, 0u);
  const TimedFault all = parse_fault("power-cycle@1");
  EXPECT_FALSE(all.joint);
  EXPECT_FALSE(all.bus);
  EXPECT_EQ(all.duration_s, 0.5);
}

TEST(FaultPlan, AFaultIsActiveFromItsStartForItsDuration) {
  const TimedFault fault = parse_fault("drop@5+0.5");
  EXPECT_FALSE(fault.active(4.999));
  EXPECT_TRUE(fault.active(5.0));
  EXPECT_TRUE(fault.active(5.499));
  EXPECT_FALSE(fault.active(5.5));
  EXPECT_TRUE(parse_fault("drop@5").active(1e9));
}

TEST(FaultPlan, AFaultAffectsItsTargetOnly) {
  const TimedFault joint = parse_fault("drop:knee_L@1");
  EXPECT_TRUE(joint.affects(0, 1));
  EXPECT_FALSE(joint.affects(0, 0));
  EXPECT_FALSE(joint.affects(0, std::nullopt)) << "the torso sensor is no joint";
  const TimedFault bus = parse_fault("drop:1@1");
  EXPECT_TRUE(bus.affects(1, std::nullopt));
  EXPECT_FALSE(bus.affects(0, 1));
  EXPECT_TRUE(parse_fault("drop@1").affects(0, std::nullopt));
}

TEST(FaultPlan, MistakesAreNamedInOneSentence) {
  for (const char* text :
       {"", "drop", "@1", "fire@1", "drop@", "drop@x", "drop@-1", "drop@1+", "drop@1+x", "drop:elbow@1",
        "drop:4@1", "bus-off:knee_L@1", "driver-fault:1@1", "emergency-stop:hip_L@1", "drop:@1"}) {
    try {
      static_cast<void>(parse_fault(text));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("--fault " + std::string(text) + ": "));
    }
  }
}

}  // namespace
}  // namespace stilt::simulation
