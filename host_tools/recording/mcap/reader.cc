#include "host_tools/recording/mcap/reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "host_tools/recording/mcap/compression.h"
#include "host_tools/recording/mcap/crc32.h"

namespace stilt::mcap {

Reader::Reader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_)
    refuse(std::string("cannot be read (") + std::strerror(errno) + "); name a record of stilt record");
  file_.seekg(0, std::ios::end);
  size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
  file_.seekg(0);
  char magic[sizeof kMagic] = {};
  file_.read(magic, sizeof magic);
  if (!file_ || std::memcmp(magic, kMagic, sizeof magic) != 0) {
    refuse("is no MCAP file; name a record of stilt record");
  }
  at_ = sizeof magic;
}

void Reader::refuse(const std::string& why) const { throw std::runtime_error(path_ + ": " + why); }

void Reader::end(const std::string& problem) {
  ended_ = true;
  if (!problem.empty()) problems_.push_back(path_ + ": " + problem);
}

const ReadMessage* Reader::next() {
  has_message_ = false;
  while (!next_in_chunk()) {
    if (ended_ || !read_record()) return nullptr;
  }
  return &message_;
}

/// @return  false at the end of the complete records
bool Reader::read_record() {
  const std::string place = "byte " + std::to_string(at_);
  char head[kRecordHead_bytes];
  if (size_ - at_ < kRecordHead_bytes || !file_.read(head, kRecordHead_bytes)) {
    end("was cut off at " + place + ", recording did not end in order");
    return false;
  }
  ByteReader reader(ByteView(reinterpret_cast<const std::uint8_t*>(head), kRecordHead_bytes));
  const Op op = static_cast<Op>(reader.take<std::uint8_t>());
  const auto length = reader.take<std::uint64_t>();
  if (length > size_ - at_ - kRecordHead_bytes) {
    end("was cut off in the record at " + place + ", recording did not end in order");
    return false;
  }
  body_.resize(length);
  if (!file_.read(reinterpret_cast<char*>(body_.data()), static_cast<std::streamsize>(length))) {
    end("cannot be read beyond " + place);
    return false;
  }
  at_ += kRecordHead_bytes + length;
  try {
    take_record(op, body_);
  } catch (const std::runtime_error& error) {
    problems_.push_back(path_ + ": " + error.what() + " (record at " + place + ")");
  }
  return !ended_;
}

void Reader::take_record(Op op, ByteView body) {
  switch (op) {
    case Op::schema:
      return take_schema(ByteReader(body));
    case Op::channel:
      return take_channel(ByteReader(body));
    case Op::message:
      throw std::runtime_error("a message outside of a chunk, where no check sum covers it");
    case Op::chunk:
      return take_chunk(body);
    case Op::attachment:
      return take_attachment(body);
    case Op::metadata:
      return take_metadata(ByteReader(body));
    case Op::footer:
      complete_ = true;
      return end("");
    default:
      return;  // index and summary; records of future versions
  }
}

void Reader::take_schema(ByteReader body) {
  Schema schema;
  schema.id = body.take<std::uint16_t>();
  schema.name = body.take_string();
  schema.encoding = body.take_string();
  schema.text = body.take_string();
  schemas_.try_emplace(schema.id, schema);
}

void Reader::take_channel(ByteReader body) {
  Channel channel;
  channel.id = body.take<std::uint16_t>();
  channel.schema_id = body.take<std::uint16_t>();
  channel.topic = body.take_string();
  channel.message_encoding = body.take_string();
  channel.metadata = body.take_map();
  channels_.try_emplace(channel.id, channel);
}

void Reader::take_message(ByteReader body) {
  Message& message = message_.message;
  message.channel_id = body.take<std::uint16_t>();
  message.sequence = body.take<std::uint32_t>();
  message.log_time_ns = body.take_time();
  message.publish_time_ns = body.take_time();
  message.data = body.take_raw(body.left());
  const auto channel = channels_.find(message.channel_id);
  if (channel == channels_.end()) throw std::runtime_error("a message of an unknown channel");
  const auto schema = schemas_.find(channel->second.schema_id);
  message_.channel = &channel->second;
  message_.schema = schema == schemas_.end() ? nullptr : &schema->second;
  has_message_ = true;
}

void Reader::take_chunk(ByteView body) {
  ByteReader reader(body);
  static_cast<void>(reader.take_time());
  static_cast<void>(reader.take_time());
  const auto size = reader.take<std::uint64_t>();
  const auto sum = reader.take<std::uint32_t>();
  const Compression compression = compression_named(reader.take_string());
  Bytes records = decompress(reader.take_raw(reader.take<std::uint64_t>()), compression, size);
  if (sum != 0 && crc32(records) != sum) throw std::runtime_error("a chunk's check sum is wrong");
  chunk_ = std::move(records);
  chunk_at_ = 0;
  chunk_reported_ = false;
}

/// Continues in the open chunk up to its next message. The first defect of a chunk is reported.
bool Reader::next_in_chunk() {
  while (!has_message_ && chunk_at_ < chunk_.size()) {
    try {
      take_record_of_chunk();
    } catch (const std::runtime_error& error) {
      if (!chunk_reported_)
        problems_.push_back(path_ + ": " + error.what() + " (in the chunk before byte " +
                            std::to_string(at_) + ")");
      chunk_reported_ = true;
    }
  }
  return has_message_;
}

/// Without a complete record the rest of the chunk is left out, else the record alone.
void Reader::take_record_of_chunk() {
  const std::size_t start = std::exchange(chunk_at_, chunk_.size());
  ByteReader reader(ByteView(chunk_).subspan(start));
  const Op op = static_cast<Op>(reader.take<std::uint8_t>());
  const ByteView body = reader.take_raw(reader.take<std::uint64_t>());
  chunk_at_ = start + reader.position();
  if (op == Op::schema) take_schema(ByteReader(body));
  if (op == Op::channel) take_channel(ByteReader(body));
  if (op == Op::message) take_message(ByteReader(body));
}

void Reader::take_attachment(ByteView body) {
  ByteReader reader(body);
  Attachment attachment;
  attachment.log_time_ns = reader.take_time();
  attachment.create_time_ns = reader.take_time();
  attachment.name = reader.take_string();
  attachment.media_type = reader.take_string();
  attachment.data = ByteReader::text(reader.take_raw(reader.take<std::uint64_t>()));
  const std::uint32_t sum = crc32(body.first(reader.position()));
  if (reader.take<std::uint32_t>() != sum) throw std::runtime_error("an attachment's check sum is wrong");
  attachments_.push_back(std::move(attachment));
}

void Reader::take_metadata(ByteReader body) {
  Metadata metadata;
  metadata.name = body.take_string();
  metadata.entries = body.take_map();
  metadata_.push_back(std::move(metadata));
}

}  // namespace stilt::mcap
