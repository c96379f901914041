// What ROS 2 tools get, read by a reader that other people wrote, with the definitions as ROS 2
// publishes them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "firmware/telemetry/ros_publisher.h"
#include "tests/firmware/telemetry/numbered_statistics.h"
#include "tests/firmware/telemetry/one_sample.h"
#include "tests/independent_readers/run_reader.h"
#include "tests/own_domain.h"
#include "tests/own_folder.h"

namespace stilt::telemetry {
namespace {

constexpr const char* kRule =
    "\n================================================================================\n";
constexpr const char* kHeader = "builtin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kTime = "int32 sec\nuint32 nanosec\n";

std::string part(const std::string& name, const std::string& text) {
  return kRule + ("MSG: " + name + "\n") + text;
}

std::string header_parts() {
  return part("std_msgs/Header", kHeader) + part("builtin_interfaces/Time", kTime);
}

/// By topic, from ROS 2's common_interfaces.
const std::map<std::string_view, std::string> kDefinitions = {
    {"rt/joint_states",
     "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" +
         header_parts()},
    {"rt/odom",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist\n" +
         header_parts() + part("geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n") +
         part("geometry_msgs/Pose", "Point position\nQuaternion orientation\n") +
         part("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n") +
         part("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n") +
         part("geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n") +
         part("geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n") +
         part("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n")},
    {"rt/diagnostics",
     "std_msgs/Header header\nDiagnosticStatus[] status\n" + header_parts() +
         part("diagnostic_msgs/DiagnosticStatus",
              "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n"
              "string hardware_id\nKeyValue[] values\n") +
         part("diagnostic_msgs/KeyValue", "string key\nstring value\n")},
    {"rt/cmd_vel", "Vector3 linear\nVector3 angular\n" +
                       part("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n")},
};

std::string hex(const Cdr& cdr) {
  std::string text;
  for (const std::byte byte : cdr) {
    text += "0123456789abcdef"[std::to_integer<int>(byte) >> 4];
    text += "0123456789abcdef"[std::to_integer<int>(byte) & 15];
  }
  return text;
}

/// Without the bytes that fill the sample up to a multiple of four; the header's last two bits count them.
Cdr without_filling(Cdr cdr) {
  const int filling = std::to_integer<int>(cdr.at(3) & std::byte{3});
  cdr.erase(cdr.end() - filling, cdr.end());
  cdr[3] = std::byte{0};
  return cdr;
}

/// The message as the independent reader decodes it; its own bytes for it must be those of the sample.
nlohmann::json read_elsewhere(std::string_view topic, const Cdr& sample) {
  const Cdr cdr = without_filling(sample);
  const tests::OwnFolder folder;
  const std::string file = folder.file("question.json");
  const nlohmann::json question = {{{"schema", kDefinitions.at(topic)}, {"cdr", hex(cdr)}}};
  std::ofstream(file) << question;
  const nlohmann::json answer = independent_readers::run_reader("rewrite_cdr.cjs", {file}).at(0);
  EXPECT_EQ(answer.at("cdr"), hex(cdr)) << topic;
  return answer.at("message");
}

using testing::one_sample;

class RosWire : public ::testing::Test {
 protected:
  void SetUp() override {
    participant = Participant::open({.domain = tests::own_domain()});
    ASSERT_TRUE(participant.has_value()) << participant.error();
    auto opened = RosPublisher::open(*participant);
    ASSERT_TRUE(opened.has_value()) << opened.error();
    publisher = std::move(*opened);
    tick.time_ns = 2'500'000'000;
    tick.stance_episode = 1;
    tick.estimated_state = {1.5, 0.8, 0.1, 0, 0, 0, 0, 0.4, -0.05, 0.2, 0, 0, 0, 0};
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      tick.joints[i].position_rad = 0.25 * static_cast<double>(i);
      tick.joints[i].velocity_rad_s = -1.0;
      tick.joints[i].torque_Nm = 12.5;
    }
  }

  std::expected<Participant, std::string> participant;
  RosPublisher publisher;
  control_loop::TickRecord tick;
  WallTime time{.start_clock_ns = 500'000'000, .start_time_ns = 1'700'000'000'250'000'000};
};

TEST_F(RosWire, joint_states_read_as_a_joint_state) {
  const Cdr cdr = one_sample(*participant, kJointStates, [&] { publisher.joint_states(tick, time); }).cdr;
  const nlohmann::json message = read_elsewhere(kJointStates.name, cdr);
  EXPECT_EQ(message.at("header").at("stamp").at("sec"), 1'700'000'002);
  EXPECT_EQ(message.at("header").at("stamp").at("nsec"), 250'000'000);
  EXPECT_EQ(message.at("name"), (std::vector<std::string>{"hip_L", "knee_L", "hip_R", "knee_R"}));
  EXPECT_EQ(message.at("position"), (std::vector<double>{0, 0.25, 0.5, 0.75}));
  EXPECT_EQ(message.at("velocity").at(3), -1.0);
  EXPECT_EQ(message.at("effort").at(0), 12.5);
}

TEST_F(RosWire, odom_reads_as_an_odometry_with_the_twist_in_the_childs_frame) {
  const Cdr cdr = one_sample(*participant, kOdometry, [&] { publisher.odometry(tick, time); }).cdr;
  const nlohmann::json message = read_elsewhere(kOdometry.name, cdr);
  EXPECT_EQ(message.at("header").at("frame_id"), "odom");
  EXPECT_EQ(message.at("child_frame_id"), "base");
  const nlohmann::json& pose = message.at("pose").at("pose");
  EXPECT_EQ(pose.at("position").at("x"), 1.5);
  EXPECT_EQ(pose.at("position").at("z"), 0.8);
  EXPECT_DOUBLE_EQ(pose.at("orientation").at("y"), std::sin(0.05));
  EXPECT_DOUBLE_EQ(pose.at("orientation").at("w"), std::cos(0.05));
  // The world's velocity again: the quaternion applied to the twist, p = v + 2 w (u x v) + 2 u x (u x v).
  const double vx = message.at("twist").at("twist").at("linear").at("x");
  const double vz = message.at("twist").at("twist").at("linear").at("z");
  EXPECT_NEAR(std::cos(0.1) * vx + std::sin(0.1) * vz, 0.4, 1e-15);
  EXPECT_NEAR(-std::sin(0.1) * vx + std::cos(0.1) * vz, -0.05, 1e-15);
  EXPECT_EQ(message.at("twist").at("twist").at("angular").at("y"), 0.2);
}

TEST_F(RosWire, odom_is_not_sent_while_the_place_of_the_base_is_unknown) {
  control_loop::TickRecord off_its_feet = tick, unread = tick;
  off_its_feet.stance_episode = 0;
  off_its_feet.estimated_state[0] = 0.0;
  unread.estimated_state[0] = 9.0;
  unread.estimated_state[2] = std::numeric_limits<double>::quiet_NaN();
  const auto send = [&] {
    for (const control_loop::TickRecord* one : {&tick, &off_its_feet, &unread}) {
      publisher.odometry(*one, time);
    }
  };
  const nlohmann::json newest = read_elsewhere(kOdometry.name, one_sample(*participant, kOdometry, send).cdr);
  EXPECT_EQ(newest.at("pose").at("pose").at("position").at("x"), 1.5);
}

TEST_F(RosWire, diagnostics_read_as_a_diagnostic_array_that_names_the_fault) {
  tick.state = supervisor::State::fault;
  tick.reaction = supervisor::Reaction::damp;
  tick.latched.add(supervisor::Fault::bus_off);
  diagnostics::FoundWords found;
  found[static_cast<std::size_t>(supervisor::Fault::bus_off)] = "bus 1 of hardware.buses";
  const Sample sample = one_sample(*participant, kDiagnostics,
                                   [&] { publisher.diagnostics(tick, {}, {}, time, "amber3m", found); });
  const nlohmann::json message = read_elsewhere(kDiagnostics.name, sample.cdr);
  ASSERT_EQ(message.at("status").size(), 6u);
  const nlohmann::json& first = message.at("status").at(0);
  EXPECT_EQ(first.at("level"), 2);
  EXPECT_EQ(first.at("hardware_id"), "amber3m");
  EXPECT_EQ(first.at("values").back().at("key"), "bus_off");
  EXPECT_EQ(first.at("values").back().at("value"), "waits for a reset: bus 1 of hardware.buses");
  EXPECT_EQ(first.at("message"), "fault; the controller of a bus took itself off: bus 1 of hardware.buses");
}

/// Level, name and message of a status, and its values.
std::string text_of(const nlohmann::json& status) {
  std::string text = std::to_string(status.at("level").get<int>()) + ' ' +
                     status.at("name").get<std::string>() + ": " + status.at("message").get<std::string>();
  for (const nlohmann::json& pair : status.at("values")) {
    text += ", " + pair.at("key").get<std::string>() + ' ' + pair.at("value").get<std::string>();
  }
  return text;
}

TEST_F(RosWire, diagnostics_have_a_status_of_the_timing_and_of_each_driver) {
  for (std::size_t i = 0; i < hal::kJoints; ++i) {
    hal::JointReading& joint = tick.joints[i];
    const double number = static_cast<double>(i);
    joint.driver_temperature_C = 40 + number;
    joint.motor_temperature_C = 50 + number;
    joint.supply_V = 46 + number;
    joint.missed_replies = static_cast<std::uint32_t>(1 + i);
    joint.state = hal::DriverState::enabled;
  }
  tick.joints[1].fault = hal::DriverFault::encoder;
  tick.joints[1].fault_code = 35;
  tick.joints[2].state = hal::DriverState::fault;
  const diagnostics::LoopStatistics loop = testing::numbered_loop_statistics();
  const diagnostics::PlannerStatistics planning = testing::numbered_planner_statistics();
  const Sample sample = one_sample(*participant, kDiagnostics,
                                   [&] { publisher.diagnostics(tick, loop, planning, time, "amber3m", {}); });
  const nlohmann::json status = read_elsewhere(kDiagnostics.name, sample.cdr).at("status");
  ASSERT_EQ(status.size(), 6u);
  EXPECT_EQ(text_of(status[1]),
            "1 stiltd: timing: 7 late ticks, ticks 101, late_ticks 7, missed_periods 11, plans 13, "
            "heap_allocations 32, page_faults 53, wakeup_latency_p99_us 1000, execution_p99_us 2000, "
            "solve_p99_us 4000");
  EXPECT_EQ(text_of(status[2]),
            "0 driver: hip_L: no fault, temperature_C 40, motor_temperature_C 50, supply_V 46, "
            "missed_replies 1, fault_code 0");
  EXPECT_EQ(text_of(status[3]),
            "2 driver: knee_L: encoder, temperature_C 41, motor_temperature_C 51, supply_V 47, "
            "missed_replies 2, fault_code 35");
  EXPECT_EQ(text_of(status[4]),
            "2 driver: hip_R: no fault, temperature_C 42, motor_temperature_C 52, supply_V 48, "
            "missed_replies 3, fault_code 0");
  EXPECT_EQ(text_of(status[5]),
            "0 driver: knee_R: no fault, temperature_C 43, motor_temperature_C 53, supply_V 49, "
            "missed_replies 4, fault_code 0");
}

TEST_F(RosWire, a_twist_of_others_reads_as_ours) {
  Twist twist{};
  twist.linear.x = 0.5;
  const nlohmann::json message = read_elsewhere(kSpeedCommands.name, encode(twist));
  EXPECT_EQ(message.at("linear").at("x"), 0.5);
}

}  // namespace
}  // namespace stilt::telemetry
