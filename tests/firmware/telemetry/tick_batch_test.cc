#include "firmware/telemetry/tick_batch.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <sstream>
#include <vector>

#include "firmware/diagnostics/tick_csv.h"
#include "firmware/telemetry/cdr.h"

namespace stilt::telemetry {
namespace {

using control_loop::TickRecord;

/// Every field that is not an enumerator or a counter with a meaning of its own gets random bits.
class RandomTicks {
 public:
  explicit RandomTicks(unsigned seed) : random_(seed) {}

  TickRecord next(std::uint64_t tick) {
    TickRecord r;
    r.tick = tick;
    for (std::int64_t* time : {&r.time_ns, &r.wakeup_ns, &r.execution_ns, &r.round_trip_ns})
      *time = integer();
    for (hal::JointReading& joint : r.joints) {
      for (double* number : {&joint.position_rad, &joint.velocity_rad_s, &joint.torque_Nm,
                             &joint.driver_temperature_C, &joint.supply_V}) {
        *number = real();
      }  // motor temperature stays NaN
      joint.time_ns = integer();
      joint.missed = small();
      joint.frozen = small();
      joint.malformed = small();
      joint.state = hal::DriverState::enabled;
      joint.fault = hal::DriverFault::over_current;
      joint.fault_code = small();
    }
    for (double* number :
         {&r.base.pitch_rad, &r.base.pitch_rate_rad_s, &r.base.acceleration_x_m_s2, &r.base.left_foot_force_N,
          &r.ramp, &r.plan_age_s, &r.gait.speed_m_s, &r.command.request.speed_m_s}) {
      *number = real();
    }
    r.base.time_ns = integer();
    r.base.missed = small();
    r.read_status = hal::JointBusStatus::incomplete;
    r.write_status = hal::JointBusStatus::bus_off;
    r.emergency_stop = hal::EmergencyStopState::pressed;
    r.bus_errors = small();
    r.bring_up = {
        true, true, 3, hal::bring_up::Stage::home, hal::bring_up::Failure::silent, hal::DriverFault::encoder};
    r.command.request.kind = supervisor::RequestKind::walk;
    r.command.request.number = small();
    r.command.shut_down = (small() & 1) != 0;
    r.command.heartbeat_expected = (small() & 1) != 0;
    r.command.heartbeat_ns = integer();
    r.tuning = small();
    r.result = {small(), small(), small(), integer(), sqp::SolveStatus::step_rejected};
    r.visible_plan = integer();
    for (double& number : r.estimated_state) number = real();
    for (hal::JointCommands* commands : {&r.wanted, &r.sent}) {
      for (hal::JointCommand& command : *commands) command = {real(), real(), real(), real(), real(), real()};
    }
    r.action = supervisor::Action::disable;
    r.state = supervisor::State::walk;
    r.level = supervisor::FallbackLevel::plan_feedback;
    r.reaction = supervisor::Reaction::sit;
    r.present = supervisor::FaultSet(small());
    r.latched = supervisor::FaultSet(small());
    r.plan_sequence = integer();
    r.standing = small();
    r.gait.kind = gait::GaitKind::walk;
    return r;
  }

 private:
  double real() { return std::normal_distribution<>()(random_); }
  std::int64_t integer() { return static_cast<std::int64_t>(random_()); }
  std::uint32_t small() { return static_cast<std::uint32_t>(random_() >> 40); }

  std::mt19937_64 random_;
};

/// A record and what became of it, written by the code for the black box: every digit of every number.
std::string text(const TickRecord& record) {
  std::ostringstream out;
  diagnostics::write_tick(out, record, 0);
  return out.str();
}

void expect_same(const TickRecord& a, const TickRecord& b) {
  EXPECT_EQ(text(a), text(b));
  EXPECT_EQ(a.read_status, b.read_status);
  EXPECT_EQ(a.write_status, b.write_status);
  EXPECT_EQ(a.emergency_stop, b.emergency_stop);
  EXPECT_EQ(a.bus_errors, b.bus_errors);
  EXPECT_EQ(a.bring_up.ready, b.bring_up.ready);
  EXPECT_EQ(a.bring_up.failed, b.bring_up.failed);
  EXPECT_EQ(a.bring_up.joint, b.bring_up.joint);
  EXPECT_EQ(a.bring_up.stage, b.bring_up.stage);
  EXPECT_EQ(a.bring_up.failure, b.bring_up.failure);
  EXPECT_EQ(a.bring_up.fault, b.bring_up.fault);
  EXPECT_EQ(a.command.request.kind, b.command.request.kind);
  EXPECT_EQ(a.command.request.number, b.command.request.number);
  EXPECT_EQ(a.command.request.speed_m_s, b.command.request.speed_m_s);
  EXPECT_EQ(a.command.shut_down, b.command.shut_down);
  EXPECT_EQ(a.command.heartbeat_expected, b.command.heartbeat_expected);
  EXPECT_EQ(a.command.heartbeat_ns, b.command.heartbeat_ns);
  EXPECT_EQ(a.tuning, b.tuning);
  EXPECT_EQ(a.result.cycles, b.result.cycles);
  EXPECT_EQ(a.result.failures_in_a_row, b.result.failures_in_a_row);
  EXPECT_EQ(a.result.session, b.result.session);
  EXPECT_EQ(a.result.solve_ns, b.result.solve_ns);
  EXPECT_EQ(a.result.status, b.result.status);
  EXPECT_EQ(a.visible_plan, b.visible_plan);
  EXPECT_EQ(a.standing, b.standing);
  EXPECT_EQ(a.gait.kind, b.gait.kind);
  EXPECT_EQ(a.gait.speed_m_s, b.gait.speed_m_s);
  EXPECT_EQ(a.base.time_ns, b.base.time_ns);
  EXPECT_EQ(a.sent[3].torque_limit_Nm, b.sent[3].torque_limit_Nm);
  EXPECT_EQ(a.wanted[0].torque_limit_Nm, b.wanted[0].torque_limit_Nm);
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    EXPECT_EQ(a.joints[i].time_ns, b.joints[i].time_ns);
    EXPECT_EQ(a.joints[i].malformed, b.joints[i].malformed);
  }
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
    for (std::size_t i = 0; i < records.size(); ++i) expect_same(records[i], tick_record(*batch, i));
  }
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
  builder.message().joint_missed._length = 3;
  EXPECT_FALSE(well_formed(builder.message()));
}

}  // namespace
}  // namespace stilt::telemetry
