#pragma once

#include <dds/dds.h>

#include <span>
#include <string_view>

/// The topics of Stilt on the wire. Names and types are those that ROS 2 gives them: rt/ before the name of
/// the topic, types of the form pkg::msg::dds_::Type_, plain CDR (XCDR1).
namespace stilt::telemetry {

/// How a topic is delivered.
enum class Delivery {
  stream,   ///< the newest counts: best effort, keeps 1
  record,   ///< every sample counts: reliable, keeps many; a subscriber that comes late gets what is kept. A
            ///< slow subscriber loses the oldest and never holds the sender up
  lasting,  ///< rare and still true later: reliable, transient-local, keeps 256
  command,  ///< reliable, keeps 256, nothing for those who come late
};

/// A DDS topic, its type and how it is delivered.
struct Topic {
  std::string_view name;  ///< on the wire, ends with a 0
  const dds_topic_descriptor_t* type;
  Delivery delivery;
  int keeps;        ///< samples kept by the sender, and by a receiver of its own
  bool from_robot;  ///< false: stiltd takes it
  /// The type as ROS 2 writes it, "sensor_msgs/msg/JointState".
  std::string_view ros_type;
};

extern const Topic kJointStates;
extern const Topic kOdometry;
extern const Topic kDiagnostics;
extern const Topic kSpeedCommands;  ///< Twist: see cmd_vel in firmware/telemetry/README.md
extern const Topic kTicks;
extern const Topic kPlannerCycles;
extern const Topic kPlans;
extern const Topic kSupervisor;
extern const Topic kEvents;
extern const Topic kTiming;
extern const Topic kConfiguration;
extern const Topic kTuning;
extern const Topic kCommands;
extern const Topic kCommandReplies;

/// All of them.
[[nodiscard]] std::span<const Topic* const> topics();

/// The topic of that name on the wire, or nullptr.
[[nodiscard]] const Topic* find_topic(std::string_view name);

/// Quality of service of a topic, to be freed with dds_delete_qos().
[[nodiscard]] dds_qos_t* quality_of(const Topic& topic);

}  // namespace stilt::telemetry
