#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

/// MCAP, a container of time-stamped messages (https://mcap.dev/spec): own reader and writer. Host only,
/// everything here may throw std::runtime_error with one sentence that names the file.
///
/// A file is magic, records of one byte operation code and a 64-bit length, magic again; all numbers are
/// little endian, strings have a 32-bit length before them, times are nanoseconds.
namespace stilt::mcap {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;
using StringMap = std::map<std::string, std::string>;

inline constexpr std::uint8_t kMagic[8] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

/// Bytes of a record's operation code and length.
inline constexpr std::size_t kRecordHead_bytes = 9;

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// How the messages of a channel are laid out, such as a ROS 2 message definition.
struct Schema {
  std::uint16_t id = 0;  ///< from 1
  std::string name;      ///< such as sensor_msgs/msg/JointState
  std::string encoding;  ///< such as ros2msg
  std::string text;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0: none
  std::string topic;
  std::string message_encoding;  ///< such as cdr
  StringMap metadata;
};

struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;      ///< when it was recorded
  std::int64_t publish_time_ns = 0;  ///< when it was sent
  ByteView data;                     ///< belongs to the giver of the message
};

/// A file within the file.
struct Attachment {
  std::int64_t log_time_ns = 0;
  std::int64_t create_time_ns = 0;
  std::string name;
  std::string media_type;
  std::string data;
};

struct Metadata {
  std::string name;
  StringMap entries;
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint32_t attachments = 0;
  std::uint32_t metadata = 0;
  std::uint32_t chunks = 0;
  std::int64_t first_time_ns = 0;
  std::int64_t last_time_ns = 0;
  std::map<std::uint16_t, std::uint64_t> messages_of_channel;
};

}  // namespace stilt::mcap
