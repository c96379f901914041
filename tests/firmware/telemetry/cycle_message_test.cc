#include "firmware/telemetry/cycle_message.h"

#include <gtest/gtest.h>

#include "firmware/telemetry/cdr.h"
#include "host_tools/recording/schema/decode.h"

namespace stilt::telemetry {
namespace {

using Json = nlohmann::ordered_json;

/// The message with the names and types of the IDL.
Json read_by_names(const PlannerCycle& message) {
  const Cdr cdr = encode(message);
  return schema::decode(schema::own_messages(), "stilt_msgs/msg/PlannerCycle",
                        {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()});
}

TEST(CycleMessage, EveryFieldOfASolveIsUnderItsNameAndComesBack) {
  control_loop::CycleRecord record;
  record.cycle = 1;
  record.tick = 2;
  record.time_s = 3.5;
  record.stance_episode = 4;
  record.plan_sequence = 5;
  record.report = {.status = sqp::SolveStatus::step_rejected,
                   .iterations = 7,
                   .cost = 8.5,
                   .dynamics_defect_max = 9.5,
                   .equality_violation_max = 10.5,
                   .violations = {18.5, 19.5, 20.5, 21.5, 22.5, 23.5},
                   .line_search_step = 11.5,
                   .step_component_max = 12.5};
  record.failures = 13;
  record.nodes = 14;
  record.solve_ns = 15;
  record.checksum = 16;
  record.tuning = 17;
  const PlannerCycle message = cycle_message(record);
  const Json expected = Json::parse(R"({"run_id": 0, "cycle": 1, "dropped": 0, "tick": 2, "time_s": 3.5,
      "stance_episode": 4, "plan_sequence": 5, "status": 2, "iterations": 7, "failures": 13, "cost": 8.5,
      "dynamics_defect_max": 9.5, "equality_violation_max": 10.5, "line_search_step": 11.5, "step_component_max": 12.5,
      "nodes": 14, "solve_ns": 15, "checksum": 16, "tuning": 17,
      "friction_cone_violation_max_N": 18.5, "pulling_force_max_N": 19.5, "impulse_cone_violation_max_Ns": 20.5,
      "torque_violation_max_Nm": 21.5, "position_violation_max_rad": 22.5, "velocity_violation_max_rad_s": 23.5})");
  EXPECT_EQ(read_by_names(message), expected);
  EXPECT_EQ(read_by_names(cycle_message(cycle_record(message))), expected);
}

}  // namespace
}  // namespace stilt::telemetry
