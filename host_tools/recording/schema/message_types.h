#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Types of ROS 2 messages: read from IDL, converted from and to ROS's notation. Host only. Throws
/// std::runtime_error with one sentence.
namespace stilt::schema {

enum class Shape {
  single,
  array,     ///< a fixed number of values
  sequence,  ///< any number of values
};

struct Field {
  std::string name;
  std::string
      type;  ///< bool, int8 to uint64, float32, float64, string, or a message such as "std_msgs/msg/Header"
  Shape shape = Shape::single;
  std::size_t count = 1;  ///< of an array
};

/// Whether `type` is a basic type.
[[nodiscard]] bool is_basic(const std::string& type);

/// Messages by name, such as "sensor_msgs/msg/JointState", with their fields in order.
using MessageTypes = std::map<std::string, std::vector<Field>>;

/// The messages of IDL in the style of ROS 2: struct Type_ in modules pkg, msg, dds_. Supports basic types,
/// strings, sequences, arrays and structures.
[[nodiscard]] MessageTypes parse_idl(std::string_view idl);

/// A message in the notation of .msg files, followed by all messages it uses, as recorders and viewers expect
/// it ("ros2msg"). ROS allows no capital letters in the names of fields: torque_Nm becomes torque_nm.
[[nodiscard]] std::string ros2msg_text(const MessageTypes& types, const std::string& name);

/// The inverse of ros2msg_text(): the message `name` and those it uses. Each that it uses is defined, and
/// none contains itself.
[[nodiscard]] MessageTypes parse_ros2msg(std::string_view text, const std::string& name);

/// The messages of this program, defined in firmware/telemetry.
[[nodiscard]] const MessageTypes& own_messages();

}  // namespace stilt::schema
