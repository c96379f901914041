#pragma once

#include <dds/dds.h>

#include "firmware/telemetry/ros2.h"
#include "firmware/telemetry/stilt_msgs.h"

/// The messages of ros2.idl and stilt_msgs.idl under names for people. They are C structures: sequences are
/// {_maximum, _length, _buffer, _release}, strings are char*.
namespace stilt::telemetry {

using JointState = sensor_msgs_msg_dds__JointState_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using DiagnosticArray = diagnostic_msgs_msg_dds__DiagnosticArray_;
using Twist = geometry_msgs_msg_dds__Twist_;
using TickBatch = stilt_msgs_msg_dds__TickBatch_;
using PlannerCycle = stilt_msgs_msg_dds__PlannerCycle_;
using Plan = stilt_msgs_msg_dds__Plan_;
using Supervisor = stilt_msgs_msg_dds__Supervisor_;
using Event = stilt_msgs_msg_dds__Event_;
using Timing = stilt_msgs_msg_dds__Timing_;
using ActiveConfiguration = stilt_msgs_msg_dds__Configuration_;
using Tuning = stilt_msgs_msg_dds__Tuning_;
using Command = stilt_msgs_msg_dds__Command_;
using CommandReply = stilt_msgs_msg_dds__CommandReply_;

/// Cyclone's description of a message: descriptor<JointState>().
template <class T>
[[nodiscard]] const dds_topic_descriptor_t& descriptor() noexcept;

template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<JointState>() noexcept {
  return sensor_msgs_msg_dds__JointState__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Odometry>() noexcept {
  return nav_msgs_msg_dds__Odometry__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<DiagnosticArray>() noexcept {
  return diagnostic_msgs_msg_dds__DiagnosticArray__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Twist>() noexcept {
  return geometry_msgs_msg_dds__Twist__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<TickBatch>() noexcept {
  return stilt_msgs_msg_dds__TickBatch__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<PlannerCycle>() noexcept {
  return stilt_msgs_msg_dds__PlannerCycle__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Plan>() noexcept {
  return stilt_msgs_msg_dds__Plan__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Supervisor>() noexcept {
  return stilt_msgs_msg_dds__Supervisor__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Event>() noexcept {
  return stilt_msgs_msg_dds__Event__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Timing>() noexcept {
  return stilt_msgs_msg_dds__Timing__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<ActiveConfiguration>() noexcept {
  return stilt_msgs_msg_dds__Configuration__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Tuning>() noexcept {
  return stilt_msgs_msg_dds__Tuning__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<Command>() noexcept {
  return stilt_msgs_msg_dds__Command__desc;
}
template <>
[[nodiscard]] inline const dds_topic_descriptor_t& descriptor<CommandReply>() noexcept {
  return stilt_msgs_msg_dds__CommandReply__desc;
}

}  // namespace stilt::telemetry
