#include "firmware/telemetry/topics.h"

#include <algorithm>
#include <string>

#include "firmware/telemetry/messages.h"
#include "firmware/telemetry/type_hashes.h"

namespace stilt::telemetry {

// Ticks: 256 batches of 50 hold the last 12.8 s of 1 kHz.
// clang-format off
constinit const Topic kJointStates{"rt/joint_states", &sensor_msgs_msg_dds__JointState__desc, Delivery::stream, 1, true, "sensor_msgs/msg/JointState"};
constinit const Topic kOdometry{"rt/odom", &nav_msgs_msg_dds__Odometry__desc, Delivery::stream, 1, true, "nav_msgs/msg/Odometry"};
constinit const Topic kDiagnostics{"rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, Delivery::command, 16, true, "diagnostic_msgs/msg/DiagnosticArray"};
constinit const Topic kSpeedCommands{"rt/cmd_vel", &geometry_msgs_msg_dds__Twist__desc, Delivery::command, 16, false, "geometry_msgs/msg/Twist"};
constinit const Topic kTicks{"rt/stilt/ticks", &stilt_msgs_msg_dds__TickBatch__desc, Delivery::record, 256, true, "stilt_msgs/msg/TickBatch"};
constinit const Topic kPlannerCycles{"rt/stilt/planner", &stilt_msgs_msg_dds__PlannerCycle__desc, Delivery::record, 8192, true, "stilt_msgs/msg/PlannerCycle"};
constinit const Topic kPlans{"rt/stilt/plan", &stilt_msgs_msg_dds__Plan__desc, Delivery::stream, 1, true, "stilt_msgs/msg/Plan"};
constinit const Topic kSupervisor{"rt/stilt/supervisor", &stilt_msgs_msg_dds__Supervisor__desc, Delivery::stream, 1, true, "stilt_msgs/msg/Supervisor"};
constinit const Topic kEvents{"rt/stilt/event", &stilt_msgs_msg_dds__Event__desc, Delivery::lasting, 256, true, "stilt_msgs/msg/Event"};
constinit const Topic kTiming{"rt/stilt/timing", &stilt_msgs_msg_dds__Timing__desc, Delivery::stream, 1, true, "stilt_msgs/msg/Timing"};
constinit const Topic kConfiguration{"rt/stilt/configuration", &stilt_msgs_msg_dds__Configuration__desc, Delivery::lasting, 1, true, "stilt_msgs/msg/Configuration"};
constinit const Topic kTuning{"rt/stilt/tuning", &stilt_msgs_msg_dds__Tuning__desc, Delivery::lasting, 256, true, "stilt_msgs/msg/Tuning"};
constinit const Topic kCommands{"rt/stilt/command", &stilt_msgs_msg_dds__Command__desc, Delivery::command, 256, false, "stilt_msgs/msg/Command"};
constinit const Topic kCommandReplies{"rt/stilt/command_reply", &stilt_msgs_msg_dds__CommandReply__desc, Delivery::command, 256, true, "stilt_msgs/msg/CommandReply"};
// clang-format on

namespace {

constexpr const Topic* kTopics[] = {&kJointStates,   &kOdometry, &kDiagnostics, &kSpeedCommands, &kTicks,
                                    &kPlannerCycles, &kPlans,    &kSupervisor,  &kEvents,        &kTiming,
                                    &kConfiguration, &kTuning,   &kCommands,    &kCommandReplies};

/// The hash of the topic's type, where ROS 2 looks for it: REP 2016.
void set_type_hash(dds_qos_t* quality, const Topic& topic) {
  const auto* row = std::ranges::find(kTypeHashes, topic.ros_type, &TypeHash::ros_type);
  if (row == std::end(kTypeHashes)) return;
  const std::string entry = "typehash=" + std::string(row->hash) + ";";
  dds_qset_userdata(quality, entry.data(), entry.size());
}

}  // namespace

std::span<const Topic* const> topics() { return kTopics; }

const Topic* find_topic(std::string_view name) {
  const auto found = std::ranges::find(kTopics, name, &Topic::name);
  return found == std::end(kTopics) ? nullptr : *found;
}

dds_qos_t* quality_of(const Topic& topic) {
  dds_qos_t* quality = dds_create_qos();
  const bool reliable = topic.delivery != Delivery::stream;
  // Nothing ever waits for a slow subscriber: what is kept fits the sender's memory (participant.cc).
  dds_qset_reliability(quality, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(quality, DDS_HISTORY_KEEP_LAST, topic.keeps);
  if (topic.delivery == Delivery::record || topic.delivery == Delivery::lasting) {
    dds_qset_durability(quality, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(quality, 0, DDS_HISTORY_KEEP_LAST, topic.keeps, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  const dds_data_representation_id_t plain_cdr = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(quality, 1, &plain_cdr);
  set_type_hash(quality, topic);
  return quality;
}

}  // namespace stilt::telemetry
