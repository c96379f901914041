#include "host_tools/web/monitor/page_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "host_tools/web/monitor/page_messages.h"

namespace stilt::monitor {
namespace {

/// The number in a column of a tick's only row.
double shown(const control_loop::TickRecord& record, const std::string& column,
             double tick_rate_hz = 1000.0) {
  const std::vector<TickSample> ticks = {{0.0, record, tick_rate_hz}};
  const SharedMessage message = ticks_message(ticks);
  const auto names = all_column_names().at("ticks").get<std::vector<std::string>>();
  const auto found = std::ranges::find(names, column);
  if (found == names.end()) throw std::out_of_range("no column " + column);
  float number;
  std::memcpy(&number,
              message->bytes.data() + 24 + sizeof number * static_cast<std::size_t>(found - names.begin()),
              sizeof number);
  return static_cast<double>(number);
}

TEST(PageTables, NumbersOfATableAreWhereItsHeadSays) {
  TickSample tick;
  tick.record.tick = 12;
  tick.time_s = 3.25;
  tick.record.estimated_state[7] = 0.5;
  tick.record.stance_episode = 1;
  TickSample later = tick;
  later.time_s = 3.5;
  const std::vector<TickSample> ticks = {tick, later};
  const SharedMessage message = ticks_message(ticks);
  const auto number_at = [&](auto zero, std::size_t offset) {
    std::memcpy(&zero, message->bytes.data() + offset, sizeof zero);
    return zero;
  };
  EXPECT_EQ(number_at(std::uint32_t{}, 4), 2u);
  EXPECT_EQ(number_at(double{}, 8), 3.25);
  EXPECT_EQ(number_at(double{}, 16), 12.0);
  const std::size_t row = (message->bytes.size() - 24) / 2;
  EXPECT_EQ(number_at(float{}, 24 + row), 0.25f);
  EXPECT_EQ(number_at(float{}, 24 + 8 * sizeof(float)), 0.5f) << "estimated_state7, after the time";
}

TEST(PageTables, TheHipOfARobotThatIsNotOnItsFeetIsUnknownAndItsJointsAreNot) {
  control_loop::TickRecord record;
  record.estimated_state.fill(0.25);
  for (const char* column :
       {"estimated_state0", "estimated_state1", "estimated_state7", "estimated_state8"}) {
    EXPECT_TRUE(std::isnan(shown(record, column))) << column;
  }
  for (const char* column :
       {"estimated_state2", "estimated_state3", "estimated_state9", "estimated_state13"}) {
    EXPECT_EQ(shown(record, column), 0.25) << column;
  }
  record.stance_episode = 1;
  EXPECT_EQ(shown(record, "estimated_state1"), 0.25);
}

TEST(PageTables, AJointThatHasNotAnsweredForATenthOfASecondIsUnknown) {
  control_loop::TickRecord record;
  record.estimated_state.fill(0.25);
  record.joints[2].torque_Nm = 7.0;
  record.joints[2].missed_replies = 100;
  EXPECT_EQ(shown(record, "estimated_state5"), 0.25);
  EXPECT_EQ(shown(record, "measured_torque_Nm2"), 7.0);
  record.joints[2].missed_replies = 101;
  for (const char* column : {"estimated_state5", "estimated_state12", "measured_torque_Nm2"}) {
    EXPECT_TRUE(std::isnan(shown(record, column))) << column;
  }
  EXPECT_EQ(shown(record, "estimated_state4"), 0.25);
  EXPECT_EQ(shown(record, "estimated_state5", 2000.0), 0.25) << "for 50 ms";
  record.joints[2].missed_replies = 51;
  EXPECT_TRUE(std::isnan(shown(record, "estimated_state5", 500.0))) << "for 102 ms";
}

TEST(PageTables, ColumnsOfATickAreThoseOfThePage) {
  std::vector<std::string> names = {"time_s"};
  const auto add = [&](const std::string& name, int count) {
    for (int k = 0; k < count; ++k) names.push_back(name + std::to_string(k));
  };
  add("estimated_state", 14);
  add("wanted_position_rad", 4);
  add("asked_torque_Nm", 4);
  add("measured_torque_Nm", 4);
  for (const char* name : {"ramp", "plan_age_ms", "wakeup_latency_us", "execution_us", "bus_round_trip_us",
                           "state_number", "fallback_level", "commanded_speed_m_s"}) {
    names.emplace_back(name);
  }
  EXPECT_EQ(all_column_names().at("ticks").get<std::vector<std::string>>(), names);
}

TEST(PageTables, AFieldStandsUnderItsColumnInItsUnit) {
  control_loop::TickRecord record;
  record.estimated_state[13] = 0.5;
  record.joints[2].torque_Nm = -3.0;
  record.plan_age_s = 0.0625;
  record.wakeup_latency_ns = 12'500;
  record.execution_ns = 1'000;
  record.bus_round_trip_ns = 250'000;
  record.state = supervisor::State::walk;
  record.gait = {gait::GaitKind::walk, 0.375};
  record.level = supervisor::FallbackLevel::plan_feedback;
  EXPECT_EQ(shown(record, "estimated_state13"), 0.5);
  EXPECT_EQ(shown(record, "measured_torque_Nm2"), -3.0);
  EXPECT_EQ(shown(record, "plan_age_ms"), 62.5);
  EXPECT_EQ(shown(record, "wakeup_latency_us"), 12.5);
  EXPECT_EQ(shown(record, "execution_us"), 1.0);
  EXPECT_EQ(shown(record, "bus_round_trip_us"), 250.0);
  EXPECT_EQ(shown(record, "commanded_speed_m_s"), 0.375);
  EXPECT_EQ(shown(record, "state_number"), static_cast<double>(supervisor::State::walk));
  EXPECT_EQ(shown(record, "fallback_level"), static_cast<double>(supervisor::FallbackLevel::plan_feedback));
}

TEST(PageTables, TheTorqueOfACommandIsItsFeedForwardAndItsGains) {
  control_loop::TickRecord record;
  record.joints[2].position_rad = 0.125;
  record.joints[2].velocity_rad_s = 0.5;
  record.sent[2] = {0.375, 1.0, 2.0, 100.0, 5.0, 80.0};
  EXPECT_EQ(shown(record, "asked_torque_Nm2"), 0.0) << "nothing was sent";
  EXPECT_TRUE(std::isnan(shown(record, "wanted_position_rad2")));
  record.action = supervisor::Action::commands;
  EXPECT_EQ(shown(record, "asked_torque_Nm2"), 2.0 + 100.0 * 0.25 + 5.0 * 0.5);
  EXPECT_EQ(shown(record, "wanted_position_rad2"), 0.375);
  record.sent[2].torque_limit_Nm = 20.0;
  EXPECT_EQ(shown(record, "asked_torque_Nm2"), 20.0) << "the limit of the driver";
}

TEST(PageTables, WithoutAGainTheWantedPositionIsThatOfPlanOrGait) {
  control_loop::TickRecord record;
  record.action = supervisor::Action::commands;
  record.joints[1].position_rad = record.sent[1].position_rad = 0.25;
  record.wanted[1].position_rad = 0.5;
  EXPECT_EQ(shown(record, "wanted_position_rad1"), 0.5);
  record.wanted[1].position_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(shown(record, "wanted_position_rad1"))) << "damped";
}

}  // namespace
}  // namespace stilt::monitor
