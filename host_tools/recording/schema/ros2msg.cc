#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>
#include <stdexcept>

#include "host_tools/recording/schema/message_types.h"

namespace stilt::schema {
namespace {

constexpr std::string_view kHeading = "MSG: ";

std::string separator() { return std::string(80, '=') + '\n'; }

/// "std_msgs/msg/Header" -> "std_msgs/Header", the form inside other messages.
std::string short_name(std::string name) {
  if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  return name;
}

std::string long_name(std::string name) {
  const std::size_t at = name.find('/');
  if (at != std::string::npos && name.find('/', at + 1) == std::string::npos) name.insert(at, "/msg");
  return name;
}

/// ROS 2 allows only lower-case letters: torque_Nm becomes torque_nm.
std::string field_name(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
  return name;
}

std::string fields_text(const std::vector<Field>& fields) {
  std::string text;
  for (const Field& field : fields) {
    text += short_name(field.type);
    if (field.shape == Shape::array) text += '[' + std::to_string(field.count) + ']';
    if (field.shape == Shape::sequence) text += "[]";
    text += ' ' + field_name(field.name) + '\n';
  }
  return text;
}

/// Appends the messages that `name` uses, in order of occurrence.
void collect(const MessageTypes& types, const std::string& name, std::vector<std::string>& used) {
  for (const Field& field : types.at(name)) {
    if (is_basic(field.type) || std::ranges::find(used, field.type) != used.end()) continue;
    used.push_back(field.type);
    collect(types, field.type, used);
  }
}

/// The number of values of an array.
std::size_t count_of(const std::string& text, const Field& field) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error == std::errc{} && end == text.data() + text.size()) return count;
  throw std::runtime_error("the field " + field.name + " has the type " + field.type +
                           ", whose number of values is none");
}

/// Parses one line "type name", "type[n] name" or "type[] name"; constants give no field.
std::vector<Field> parse_line(std::string line) {
  line.erase(std::find(line.begin(), line.end(), '#'), line.end());
  std::istringstream words(line);
  Field field;
  if (!(words >> field.type)) return {};
  if (!(words >> field.name)) throw std::runtime_error("ros2msg: the field \"" + line + "\" has no name");
  if (field.name.find('=') != std::string::npos) return {};
  if (std::string next; words >> next && next.starts_with('=')) return {};
  if (const std::size_t open = field.type.find('['); open != std::string::npos) {
    const std::string count = field.type.substr(open + 1, field.type.find(']') - open - 1);
    const bool fixed = !count.empty() && !count.starts_with("<=");
    field.shape = fixed ? Shape::array : Shape::sequence;
    if (fixed) field.count = count_of(count, field);
    field.type.erase(open);
  }
  if (field.type == "byte" || field.type == "char") field.type = "uint8";
  if (field.type.starts_with("string<=")) field.type = "string";
  return {field};
}

/// The full name of a type: a message may omit its own package.
std::string resolved(const std::string& type, const std::string& user) {
  if (is_basic(type)) return type;
  if (type == "Header") return "std_msgs/msg/Header";
  return type.find('/') == std::string::npos ? user.substr(0, user.rfind('/') + 1) + type : long_name(type);
}

/// Refuses a message that uses an unknown one, or that contains itself.
/// @param outer    those that contain it
/// @param checked  those without a defect
void check(const MessageTypes& types, const std::string& name, std::vector<std::string>& outer,
           std::set<std::string>& checked) {
  constexpr std::size_t kDeepest = 100;
  if (outer.size() > kDeepest) throw std::runtime_error("its messages contain each other 100 times");
  outer.push_back(name);
  for (const Field& field : types.at(name)) {
    if (is_basic(field.type) || checked.contains(field.type)) continue;
    if (!types.contains(field.type)) {
      throw std::runtime_error("the field " + field.name + " of " + name + " has the type " + field.type +
                               ", which is not defined");
    }
    if (std::ranges::find(outer, field.type) != outer.end()) {
      throw std::runtime_error("the message " + field.type + " contains itself");
    }
    check(types, field.type, outer, checked);
  }
  outer.pop_back();
  checked.insert(name);
}

}  // namespace

std::string ros2msg_text(const MessageTypes& types, const std::string& name) {
  if (!types.contains(name)) throw std::runtime_error("the message " + name + " is not known");
  std::string text = fields_text(types.at(name));
  std::vector<std::string> used;
  collect(types, name, used);
  for (const std::string& other : used) {
    text += separator() + std::string(kHeading) + short_name(other) + '\n' + fields_text(types.at(other));
  }
  return text;
}

MessageTypes parse_ros2msg(std::string_view text, const std::string& name) {
  MessageTypes types;
  std::string current = name;
  types[current] = {};
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====")) continue;
    if (line.starts_with(kHeading)) {
      current = long_name(line.substr(kHeading.size()));
      types[current] = {};
      continue;
    }
    for (Field& field : parse_line(line)) {
      field.type = resolved(field.type, current);
      types[current].push_back(field);
    }
  }
  std::vector<std::string> outer;
  std::set<std::string> checked;
  check(types, name, outer, checked);
  return types;
}

}  // namespace stilt::schema
