#include "firmware/supervisor/fault.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "tests/firmware/supervisor/printers.h"

namespace stilt::supervisor {
namespace {

TEST(FaultTable, EveryFaultStandsInItsOwnRow) {
  for (std::size_t i = 0; i < kFaults; ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kFaultTable[i].fault), i) << kFaultTable[i].name;
  }
}

TEST(FaultTable, NamesAndNumbersAreUnique) {
  std::set<std::string> names;
  std::set<int> numbers;
  for (const FaultRow& fault : kFaultTable) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    EXPECT_TRUE(numbers.insert(fault.number).second) << fault.name;
  }
}

/// Records of old runs and other programs rely on these.
TEST(FaultTable, NamesAndNumbersNeverChange) {
  const std::map<int, std::string> published = {
      {101, "joint_position_limit"},
      {102, "joint_speed_limit"},
      {103, "joint_torque_limit"},
      {104, "base_pitch_limit"},
      {105, "following_error"},
      {106, "hip_height_limit"},
      {201, "encoder_frozen"},
      {202, "stale_torso_sensor"},
      {203, "encoder_jump"},
      {204, "torso_sensor_implausible"},
      {301, "missed_replies"},
      {302, "lost_replies"},
      {303, "bus_error"},
      {304, "bus_off"},
      {305, "bus_disconnected"},
      {401, "driver_fault"},
      {402, "driver_not_enabled"},
      {403, "driver_hot"},
      {404, "driver_overheated"},
      {405, "low_voltage"},
      {406, "high_voltage"},
      {407, "torque_mismatch"},
      {501, "stale_plan"},
      {502, "failed_solves"},
      {503, "planner_overrun"},
      {504, "torque_loop_overrun"},
      {505, "torque_loop_stalled"},
      {506, "not_finite"},
      {507, "plan_missing"},
      {508, "planner_lost"},
      {601, "heartbeat_lost"},
      {602, "emergency_stop"},
      {603, "bring_up_failed"},
      {604, "operator_gone"},
  };
  std::map<int, std::string> table;
  for (const FaultRow& fault : kFaultTable) table[fault.number] = fault.name;
  EXPECT_EQ(table, published);
}

TEST(FaultTable, SeverityAndReactionFitTogether) {
  for (const FaultRow& fault : kFaultTable) {
    SCOPED_TRACE(fault.name);
    EXPECT_EQ(fault.severity == Severity::warning, fault.reaction == Reaction::warn);
    EXPECT_EQ(fault.severity == Severity::latched, fault.reaction >= Reaction::sit)
        << "what ends walking must not come and go";
    EXPECT_NE(std::string(fault.cause), "");
    EXPECT_NE(std::string(fault.clears), "");
  }
}

TEST(FaultSet, KeepsWhatIsAddedAndNothingElse) {
  FaultSet set;
  EXPECT_TRUE(set.empty());
  set.add(Fault::bus_off);
  set.add_if(false, Fault::low_voltage);
  set.add_if(true, Fault::stale_plan);
  EXPECT_EQ(set.count(), 2);
  EXPECT_TRUE(set.has(Fault::bus_off));
  EXPECT_TRUE(set.has(Fault::stale_plan));
  EXPECT_FALSE(set.has(Fault::low_voltage));
  EXPECT_EQ((set - set), FaultSet());
}

TEST(FaultSet, IsPrintedWithTheNamesOfItsFaults) {
  FaultSet set;
  EXPECT_EQ(::testing::PrintToString(set), "{}");
  set.add(Fault::bus_off);
  set.add(Fault::stale_plan);
  const std::string text = ::testing::PrintToString(set);
  EXPECT_TRUE(text == "{bus_off, stale_plan}" || text == "{stale_plan, bus_off}") << text;
}

TEST(FaultSet, TheHardestReactionWins) {
  FaultSet set;
  EXPECT_EQ(reaction(set), Reaction::none);
  set.add(Fault::failed_solves);
  EXPECT_EQ(reaction(set), Reaction::warn);
  set.add(Fault::low_voltage);
  EXPECT_EQ(reaction(set), Reaction::sit);
  set.add(Fault::missed_replies);
  EXPECT_EQ(reaction(set), Reaction::sit);
  set.add(Fault::emergency_stop);
  EXPECT_EQ(reaction(set), Reaction::damp);
}

}  // namespace
}  // namespace stilt::supervisor
