#include "firmware/control_loop/tick_fields.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace stilt::control_loop {
namespace {

/// 255 in every byte of a record that belongs to a value, 0 in those between them. The compiler knows which.
std::vector<unsigned char> bytes_of_values() {
  alignas(TickRecord) unsigned char memory[sizeof(TickRecord)];
  std::memset(memory, 255, sizeof memory);
  __builtin_clear_padding(reinterpret_cast<TickRecord*>(memory));
  return {memory, memory + sizeof memory};
}

TEST(TickFields, HaveEveryByteOfARecordOnce) {
  const TickRecord record;
  std::vector<unsigned char> left = bytes_of_values();
  const auto take = [&](const auto& value, std::string_view name) {
    const auto first = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&value) -
                                                reinterpret_cast<const unsigned char*>(&record));
    auto value_only = value;
    std::memset(static_cast<void*>(&value_only), 255, sizeof value_only);
    __builtin_clear_padding(&value_only);
    for (std::size_t i = 0; i < sizeof value; ++i) {
      EXPECT_EQ(left.at(first + i), reinterpret_cast<const unsigned char*>(&value_only)[i]) << name;
      left[first + i] = 0;
    }
  };
  take(record.tick, "tick");
  for_each_tick_field([&](const auto& field) {
    for (std::size_t i = 0; i < field.count(); ++i) take(field.at(record, i), field.wire);
  });
  for (std::size_t i = 0; i < left.size(); ++i) {
    EXPECT_EQ(left[i], 0) << "byte " << i << " of a record is in no field";
  }
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
                            "standing0",
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
  EXPECT_EQ(unit_factor("late_ns", "wakeup_us"), 1e-3);
  EXPECT_EQ(unit_factor("plan_age_s", "plan_age_ms"), 1e3);
  EXPECT_EQ(unit_factor("plan_age_s", "plan_age_s"), 1.0);
  EXPECT_EQ(unit_factor("rung", "rung"), 1.0);
}

}  // namespace
}  // namespace stilt::control_loop
