#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Types of ROS 2 messages: from IDL, from and to ROS's own notation. Host only, throws std::runtime_error
/// with one sentence.
namespace stilt::schema {

enum class Shape {
  single,
  array,     ///< a fixed number of them
  sequence,  ///< any number of them
};

struct Field {
  std::string name;
  std::string
      type;  ///< bool, int8 to uint64, float32, float64, string, or a message such as "std_msgs/msg/Header"
  Shape shape = Shape::single;
  std::size_t count = 1;  ///< of an array
};

/// A field of the basic types.
[[nodiscard]] bool is_basic(const std::string& type);

/// Messages by name, such as "sensor_msgs/msg/JointState", fields in their order.
using MessageTypes = std::map<std::string, std::vector<Field>>;

/// The messages of IDL as ROS 2 writes it: struct Type_ in modules pkg, msg, dds_. Knows what such messages
/// use: basic types, strings, sequences, arrays, structures.
[[nodiscard]] MessageTypes parse_idl(std::string_view idl);

/// A message in the notation of .msg files, with all messages it uses behind it: "ros2msg" of recorders and
/// viewers. ROS allows no capital letters in the names of fields: torque_Nm is torque_nm there.
[[nodiscard]] std::string ros2msg_text(const MessageTypes& types, const std::string& name);

/// The inverse: the message `name` and those it uses.
[[nodiscard]] MessageTypes parse_ros2msg(std::string_view text, const std::string& name);

/// The messages of this program: those of firmware/telemetry.
[[nodiscard]] const MessageTypes& own_messages();

}  // namespace stilt::schema
