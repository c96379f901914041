#include "firmware/telemetry/tick_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <regex>
#include <string_view>
#include <type_traits>
#include <vector>

#include "firmware/control_loop/tick_fields.h"
#include "firmware/telemetry/cdr.h"
#include "host_tools/recording/schema/decode.h"
#include "host_tools/recording/schema/idl_texts.h"

namespace stilt::telemetry {
namespace {

using control_loop::for_each_tick_field;
using control_loop::TickRecord;

constexpr const char* kType = "stilt_msgs/msg/TickBatch";

/// The last enumerator of every field that is an enumeration.
const std::map<std::string_view, int> kLastNumber = {
    {"read_status", static_cast<int>(hal::JointBusStatus::disconnected)},
    {"write_status", static_cast<int>(hal::JointBusStatus::disconnected)},
    {"driver_state", static_cast<int>(hal::DriverState::fault)},
    {"driver_fault", static_cast<int>(hal::DriverFault::other)},
    {"emergency_stop", static_cast<int>(hal::EmergencyStopState::absent)},
    {"bring_up_stage", static_cast<int>(hal::bring_up::Stage::failed)},
    {"bring_up_failure", static_cast<int>(hal::bring_up::Failure::wrong_version)},
    {"bring_up_fault", static_cast<int>(hal::DriverFault::other)},
    {"bring_up_setting", static_cast<int>(hal::bring_up::Setting::odrive_other_endpoints)},
    {"request_kind", static_cast<int>(supervisor::RequestKind::cut)},
    {"result_status", static_cast<int>(sqp::SolveStatus::infeasible)},
    {"action", static_cast<int>(supervisor::Action::disable)},
    {"state", static_cast<int>(supervisor::State::watch)},
    {"fallback_level", static_cast<int>(supervisor::FallbackLevel::off)},
    {"reaction", static_cast<int>(supervisor::Reaction::off)},
    {"gait", static_cast<int>(gait::GaitKind::walk)},
};

/// Records with random bits in every field; small numbers where the message has fewer bits than the record.
/// Enumerations have random enumerators.
class RandomTicks {
 public:
  explicit RandomTicks(unsigned seed) : random_(seed) {}

  TickRecord next(std::uint64_t tick) {
    TickRecord record;
    record.tick = tick;
    for_each_tick_field([&](const auto& field) {
      for (std::size_t i = 0; i < field.count(); ++i) fill(field.at(record, i), field.wire);
    });
    record.bring_up.joint &= 255;
    return record;
  }

 private:
  template <class Value>
  void fill(Value& value, std::string_view wire) {
    if constexpr (std::is_same_v<Value, bool>) {
      value = (random_() & 1) != 0;
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(random_() % static_cast<std::uint64_t>(kLastNumber.at(wire) + 1));
    } else {
      const std::uint64_t bits = random_();
      std::memcpy(static_cast<void*>(&value), &bits, sizeof value);
    }
  }

  std::mt19937_64 random_;
};

void expect_same_bits(const TickRecord& a, const TickRecord& b) {
  EXPECT_EQ(a.tick, b.tick);
  for_each_tick_field([&](const auto& field) {
    for (std::size_t i = 0; i < field.count(); ++i) {
      EXPECT_EQ(std::memcmp(&field.at(a, i), &field.at(b, i), sizeof field.at(a, i)), 0) << field.wire;
    }
  });
}

TEST(TickBatch, EveryFieldOfEveryTickComesBackOverTheWire) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  RandomTicks ticks(kSeed);
  TickBatchBuilder builder;
  for (int round = 0; round < 3; ++round) {
    std::vector<TickRecord> records;
    builder.clear();
    for (std::uint64_t tick = 100; tick < 100 + kTicksPerBatch; ++tick) {
      records.push_back(ticks.next(tick));
      ASSERT_TRUE(builder.takes(records.back()));
      builder.add(records.back());
    }
    const auto batch = decode<TickBatch>(encode(builder.message()));
    ASSERT_NE(batch, nullptr);
    ASSERT_TRUE(well_formed(*batch));
    ASSERT_EQ(batch->count, kTicksPerBatch);
    for (std::size_t i = 0; i < records.size(); ++i) expect_same_bits(records[i], tick_record(*batch, i));
  }
}

/// How many numbers a tick has in a sequence, as the comment of the IDL says: "// 4, ...".
std::size_t count_in_idl(const std::string& name) {
  const std::string idl(schema::kStiltIdl);
  std::smatch found;
  const bool several = std::regex_search(idl, found, std::regex("> " + name + "; *// ([0-9]+)(,|:|\n)"));
  return several ? std::stoul(found[1]) : 1;
}

TEST(TickBatch, TheIdlHasTheFieldsOfTheTableInItsOrder) {
  const std::vector<schema::Field>& idl = schema::own_messages().at(kType);
  std::size_t at = idl.size() - control_loop::kTickFieldCount;
  EXPECT_EQ(idl.at(at - 1).name, "count") << "sequences begin after it";
  for_each_tick_field([&](const auto& field) {
    const schema::Field& expected = idl.at(at++);
    EXPECT_EQ(field.wire, expected.name);
    EXPECT_EQ(expected.shape, schema::Shape::sequence) << field.wire;
    EXPECT_EQ(field.count(), count_in_idl(expected.name)) << field.wire;
  });
}

/// Read by names, with the types of the IDL.
TEST(TickBatch, NumbersAreUnderTheirNamesInTheMessage) {
  constexpr unsigned kSeed = 8;
  SCOPED_TRACE(kSeed);
  RandomTicks ticks(kSeed);
  TickBatchBuilder builder;
  builder.add(ticks.next(1));
  const TickRecord r = ticks.next(2);
  builder.add(r);
  const Cdr cdr = encode(builder.message());
  const auto message = schema::decode(schema::own_messages(), kType,
                                      {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()});
  const auto expect = [&]<class Value>(const char* name, const Value& value, std::size_t count = 1,
                                       std::size_t index = 0) {
    const auto& numbers = message.at(name);
    ASSERT_EQ(numbers.size(), 2 * count) << name;
    const auto number = numbers.at(count + index).template get<Value>();
    EXPECT_EQ(std::memcmp(&number, &value, sizeof value), 0) << name;
  };
  expect("wakeup_latency_ns", r.wakeup_latency_ns);
  expect("execution_ns", r.execution_ns);
  expect("write_status", static_cast<std::uint8_t>(r.write_status));
  expect("joint_velocity_rad_s", r.joints[3].velocity_rad_s, 4, 3);
  expect("motor_temperature_C", r.joints[0].motor_temperature_C, 4, 0);
  expect("joint_missed_replies", r.joints[1].missed_replies, 4, 1);
  expect("joint_unchanged_replies", r.joints[1].unchanged_replies, 4, 1);
  expect("driver_fault", static_cast<std::uint8_t>(r.joints[2].fault), 4, 2);
  expect("base_acceleration_z_m_s2", r.base.acceleration_z_m_s2);
  expect("right_foot_force_N", r.base.right_foot_force_N);
  expect("base_unchanged_replies", r.base.unchanged_replies);
  expect("bring_up_joint", static_cast<std::uint8_t>(r.bring_up.joint));
  expect("bring_up_failure", static_cast<std::uint8_t>(r.bring_up.failure));
  expect("request_speed_m_s", r.command.request.speed_m_s);
  expect("visible_plan", r.visible_plan);
  expect("result_failures", r.result.failures_in_a_row);
  expect("result_stance_episode", r.result.stance_episode);
  expect("estimated_state", r.estimated_state[8], 14, 8);
  expect("wanted_kp_Nm_rad", r.wanted[3].kp_Nm_rad, 4, 3);
  expect("sent_kd_Nms_rad", r.sent[1].kd_Nms_rad, 4, 1);
  expect("sent_torque_limit_Nm", r.sent[1].torque_limit_Nm, 4, 1);
  expect("fallback_level", static_cast<std::uint8_t>(r.level));
  expect("latched_faults", r.latched.bits());
  expect("plan_sequence", r.plan_sequence);
  expect("stance_episode", r.stance_episode);
  expect("gait", static_cast<std::uint8_t>(r.gait.kind));
}

TEST(TickBatch, TakesOnlyWhatFollowsAndOnlySoMany) {
  TickBatchBuilder builder;
  TickRecord record;
  record.tick = 5;
  EXPECT_TRUE(builder.takes(record));
  builder.add(record);
  EXPECT_FALSE(builder.takes(record));
  record.tick = 7;
  EXPECT_FALSE(builder.takes(record));
  for (record.tick = 6; builder.takes(record); ++record.tick) builder.add(record);
  EXPECT_EQ(builder.size(), kTicksPerBatch);
  builder.clear();
  EXPECT_EQ(builder.size(), 0u);
  EXPECT_TRUE(builder.takes(record));
}

TEST(TickBatch, AMessageThatLacksNumbersIsNotWellFormed) {
  TickBatchBuilder builder;
  builder.add(TickRecord());
  EXPECT_TRUE(well_formed(builder.message()));
  builder.message().joint_missed_replies._length = 3;
  EXPECT_FALSE(well_formed(builder.message()));
}

/// Of a batch of two ticks, the second with this number in the field of that name, for the last of its
/// values.
template <class Field>
bool is_well_formed_with(const Field& field, int number) {
  TickRecord record;
  TickBatchBuilder builder;
  builder.add(record);
  ++record.tick;
  auto& value = field.at(record, field.count() - 1);
  value = static_cast<std::remove_cvref_t<decltype(value)>>(number);
  builder.add(record);
  return well_formed(builder.message());
}

TEST(TickBatch, AMessageWithANumberThatIsNoEnumeratorIsNotWellFormed) {
  std::size_t enumerations = 0;
  for_each_tick_field([&](const auto& field) {
    if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(field.at(std::declval<TickRecord&>()))>>) {
      const int last = kLastNumber.at(field.wire);
      EXPECT_TRUE(is_well_formed_with(field, last)) << field.wire;
      EXPECT_FALSE(is_well_formed_with(field, last + 1)) << field.wire;
      EXPECT_FALSE(is_well_formed_with(field, 255)) << field.wire;
      ++enumerations;
    }
  });
  EXPECT_EQ(enumerations, kLastNumber.size());
}

}  // namespace
}  // namespace stilt::telemetry
