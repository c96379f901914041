#include "host_tools/replay/difference.h"

#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

namespace stilt::replay {
namespace {

using control_loop::CycleRecord;
using control_loop::TickRecord;

/// A field of a record: what a replay calls it, and a change of it. An empty name: an input of the replay.
template <class Record>
struct Change {
  const char* name;
  std::function<void(Record&)> make;
};

/// The next value: the last bit of a number, the next of an enumeration.
constexpr auto change = [](auto& value) {
  using Value = std::remove_reference_t<decltype(value)>;
  if constexpr (std::is_same_v<Value, double>) {
    value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ 1);
  } else if constexpr (std::is_same_v<Value, supervisor::FaultSet>) {
    value = supervisor::FaultSet(value.bits() ^ 1);
  } else {
    value = static_cast<Value>(static_cast<int>(value) + 1);
  }
};

const std::vector<Change<TickRecord>> kTickFields = {
    {"tick", [](TickRecord& r) { change(r.tick); }},
    {"", [](TickRecord& r) { change(r.time_ns); }},
    {"", [](TickRecord& r) { change(r.joints[2].position_rad); }},
    {"", [](TickRecord& r) { change(r.base.pitch_rad); }},
    {"", [](TickRecord& r) { change(r.read_status); }},
    {"", [](TickRecord& r) { change(r.write_status); }},
    {"", [](TickRecord& r) { change(r.emergency_stop); }},
    {"", [](TickRecord& r) { change(r.bus_errors); }},
    {"", [](TickRecord& r) { change(r.bring_up.stage); }},
    {"", [](TickRecord& r) { change(r.command.request.number); }},
    {"tuning", [](TickRecord& r) { change(r.tuning); }},
    {"", [](TickRecord& r) { change(r.result.cycles); }},
    {"", [](TickRecord& r) { change(r.visible_plan); }},
    {"estimated state of 0", [](TickRecord& r) { change(r.estimated_state[0]); }},
    {"estimated state of 13", [](TickRecord& r) { change(r.estimated_state[13]); }},
    {"wanted torque_Nm of hip_L", [](TickRecord& r) { change(r.wanted[0].torque_Nm); }},
    {"wanted position_rad of knee_R", [](TickRecord& r) { change(r.wanted[3].position_rad); }},
    {"sent torque_Nm of hip_L", [](TickRecord& r) { change(r.sent[0].torque_Nm); }},
    {"sent position_rad of knee_L", [](TickRecord& r) { change(r.sent[1].position_rad); }},
    {"sent velocity_rad_s of hip_R", [](TickRecord& r) { change(r.sent[2].velocity_rad_s); }},
    {"sent kp_Nm_rad of knee_R", [](TickRecord& r) { change(r.sent[3].kp_Nm_rad); }},
    {"sent kd_Nms_rad of hip_L", [](TickRecord& r) { change(r.sent[0].kd_Nms_rad); }},
    {"sent torque_limit_Nm of knee_L", [](TickRecord& r) { change(r.sent[1].torque_limit_Nm); }},
    {"action", [](TickRecord& r) { change(r.action); }},
    {"state", [](TickRecord& r) { change(r.state); }},
    {"level", [](TickRecord& r) { change(r.level); }},
    {"reaction", [](TickRecord& r) { change(r.reaction); }},
    {"present faults", [](TickRecord& r) { change(r.present); }},
    {"latched faults", [](TickRecord& r) { change(r.latched); }},
    {"ramp", [](TickRecord& r) { change(r.ramp); }},
    {"sequence of the plan in use", [](TickRecord& r) { change(r.plan_sequence); }},
    {"plan_age_s", [](TickRecord& r) { change(r.plan_age_s); }},
    {"standing", [](TickRecord& r) { change(r.standing); }},
    {"gait", [](TickRecord& r) { change(r.gait.kind); }},
    {"gait speed_m_s", [](TickRecord& r) { change(r.gait.speed_m_s); }},
    {"", [](TickRecord& r) { change(r.wakeup_ns); }},
    {"", [](TickRecord& r) { change(r.execution_ns); }},
    {"", [](TickRecord& r) { change(r.round_trip_ns); }},
};

const std::vector<Change<CycleRecord>> kCycleFields = {
    {"number of solves", [](CycleRecord& r) { change(r.cycle); }},
    {"", [](CycleRecord& r) { change(r.tick); }},
    {"time_s of the plan's request", [](CycleRecord& r) { change(r.time_s); }},
    {"standing of the plan's request", [](CycleRecord& r) { change(r.standing); }},
    {"sequence of the plan", [](CycleRecord& r) { change(r.plan_sequence); }},
    {"failures in a row", [](CycleRecord& r) { change(r.failures); }},
    {"", [](CycleRecord& r) { change(r.tuning); }},
    {"nodes of the plan", [](CycleRecord& r) { change(r.nodes); }},
    {"check sum of the plan", [](CycleRecord& r) { change(r.checksum); }},
    {"", [](CycleRecord& r) { change(r.solve_ns); }},
    {"status of the solve", [](CycleRecord& r) { change(r.report.status); }},
    {"iterations of the solve", [](CycleRecord& r) { change(r.report.iterations); }},
    {"cost of the solve", [](CycleRecord& r) { change(r.report.cost); }},
    {"dynamics_defect_max of the solve", [](CycleRecord& r) { change(r.report.dynamics_defect_max); }},
    {"equality_violation_max of the solve", [](CycleRecord& r) { change(r.report.equality_violation_max); }},
    {"step_length of the solve", [](CycleRecord& r) { change(r.report.step_length); }},
    {"step_size of the solve", [](CycleRecord& r) { change(r.report.step_size); }},
};

template <class Record>
void expect_every_output_is_compared(const std::vector<Change<Record>>& fields) {
  const Record recorded{};
  EXPECT_FALSE(compare(recorded, recorded));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Record replayed = recorded;
    fields[i].make(replayed);
    const std::optional<Difference> difference = compare(recorded, replayed);
    EXPECT_EQ(difference ? difference->what : "", fields[i].name) << "field " << i;
    EXPECT_TRUE(!difference || difference->recorded != difference->replayed) << fields[i].name;
  }
}

TEST(Difference, OneBitOfAnyOutputOfATickIsFoundAndNamed) { expect_every_output_is_compared(kTickFields); }

TEST(Difference, OneBitOfAnyOutputOfASolveIsFoundAndNamed) { expect_every_output_is_compared(kCycleFields); }

/// Does not compile once a record has another field, which then is missing in the tables above.
TEST(Difference, TheTablesAboveHaveEveryFieldOfTheRecords) {
  const auto& [tick, time, joints, base, read, write, stop, errors, bring_up, command, tuning, result,
               visible, state, wanted, sent, action, supervisor_state, level, reaction, present, latched, ramp,
               sequence, age, standing, gait, wakeup, execution, round_trip] = TickRecord{};
  const auto& [cycle, of_tick, cycle_time, cycle_standing, plan, failures, cycle_tuning, nodes, checksum,
               solve, report] = CycleRecord{};
  EXPECT_EQ(tick + cycle, 0u);
}

TEST(Difference, TheEarliestOutputIsNamedWithBothValues) {
  TickRecord recorded;
  recorded.tick = 812;
  recorded.sent[1].torque_Nm = 1.25;
  recorded.estimated_state[2] = 0.1;
  TickRecord replayed = recorded;
  replayed.sent[1].torque_Nm = 1.5;
  EXPECT_EQ(compare(recorded, replayed)->text(), "tick 812: sent torque_Nm of knee_L was 1.25 and is 1.5");
  replayed.estimated_state[2] = 0.2;
  EXPECT_EQ(compare(recorded, replayed)->text(), "tick 812: estimated state of 2 was 0.1 and is 0.2");
}

TEST(Difference, EqualBitsThatAreNoNumbersAreNoDifference) {
  TickRecord recorded;
  recorded.plan_age_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(compare(recorded, recorded));
  recorded.plan_age_s = 0.0;
  TickRecord replayed = recorded;
  replayed.plan_age_s = -0.0;
  EXPECT_TRUE(compare(recorded, replayed));
}

}  // namespace
}  // namespace stilt::replay
