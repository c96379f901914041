#include "firmware/control_loop/tick_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace stilt::control_loop {
namespace {

struct Anything {
  template <class Value>
  operator Value() const;  // NOLINT(google-explicit-constructor)
};

/// Number of members of an aggregate: as many as it can be initialised with.
template <class Aggregate, class... Values>
consteval std::size_t members(Values... values) {
  if constexpr (requires { Aggregate{values..., Anything()}; }) {
    return members<Aggregate>(values..., Anything());
  } else {
    return sizeof...(Values);
  }
}

constexpr std::size_t kStructures = 8;  // joints, base, bring_up, command, result, wanted, sent, gait
constexpr std::size_t kMembersOfARecord =
    members<TickRecord>() - kStructures + members<hal::JointReading>() + members<hal::BaseReading>() +
    members<hal::BringUpProgress>() + members<OperatorCommand>() - 1 + members<supervisor::Request>() +
    members<PlanningResult>() + 2 * members<hal::JointCommand>() + members<gait::GaitCommand>();

TEST(TickFields, AreAllMembersOfARecordEachOnce) {
  EXPECT_EQ(kTickFieldCount + 1, kMembersOfARecord) << "one for the number of the tick";
  const TickRecord record;
  std::set<const void*> places = {&record.tick};
  for_each_tick_field([&](const auto& field) {
    for (std::size_t i = 0; i < field.count(); ++i) {
      EXPECT_TRUE(places.insert(&field.at(record, i)).second) << field.wire << " is there twice";
    }
  });
}

TEST(TickFields, OfAGroupHaveEquallyManyValues) {
  std::map<TickGroup, std::size_t> counts;
  for_each_tick_field([&](const auto& field) {
    const auto group = std::remove_cvref_t<decltype(field)>::kGroup;
    EXPECT_EQ(counts.try_emplace(group, field.count()).first->second, field.count()) << field.wire;
  });
  EXPECT_EQ(counts.size(), kTickGroups);
}

TEST(TickFields, OutputsComeInTheOrderOfTheWorkJointByJoint) {
  std::vector<std::string> names;
  for_each_output([&](const auto& field, std::size_t i) {
    names.push_back(std::string(field.wire) + std::to_string(i));
  });
  const auto place = [&](const char* name) {
    const auto found = std::ranges::find(names, name);
    EXPECT_NE(found, names.end()) << name;
    return found - names.begin();
  };
  const char* in_order[] = {"estimated_state0",
                            "estimated_state13",
                            "present_faults0",
                            "reaction0",
                            "state0",
                            "ramp0",
                            "stance_episode0",
                            "plan_age_s0",
                            "tuning0",
                            "wanted_position_rad0",
                            "wanted_torque_Nm0",
                            "wanted_position_rad1",
                            "wanted_torque_limit_Nm3",
                            "action0",
                            "sent_kp_Nm_rad0"};
  for (std::size_t i = 1; i < std::size(in_order); ++i) {
    EXPECT_LT(place(in_order[i - 1]), place(in_order[i])) << in_order[i];
  }
}

TEST(TickFields, AreShownInTheUnitOfTheirName) {
  EXPECT_EQ(unit_factor("wakeup_latency_ns", "wakeup_latency_us"), 1e-3);
  EXPECT_EQ(unit_factor("plan_age_s", "plan_age_ms"), 1e3);
  EXPECT_EQ(unit_factor("plan_age_s", "plan_age_s"), 1.0);
  EXPECT_EQ(unit_factor("fallback_level", "fallback_level"), 1.0);
}

}  // namespace
}  // namespace stilt::control_loop
