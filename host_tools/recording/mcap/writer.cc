#include "host_tools/recording/mcap/writer.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "host_tools/recording/mcap/crc32.h"

namespace stilt::mcap {
namespace {

void put_record(ByteWriter& out, Op op, ByteView body) {
  out.put(static_cast<std::uint8_t>(op));
  out.put(static_cast<std::uint64_t>(body.size()));
  out.put_raw(body);
}

Bytes record(Op op, const ByteWriter& body) {
  ByteWriter out;
  put_record(out, op, body.bytes());
  return out.bytes();
}

Bytes record_of(const Schema& schema) {
  ByteWriter body;
  body.put(schema.id);
  body.put_string(schema.name);
  body.put_string(schema.encoding);
  body.put_string(schema.text);
  return record(Op::schema, body);
}

Bytes record_of(const Channel& channel) {
  ByteWriter body;
  body.put(channel.id);
  body.put(channel.schema_id);
  body.put_string(channel.topic);
  body.put_string(channel.message_encoding);
  body.put_map(channel.metadata);
  return record(Op::channel, body);
}

Bytes record_of(const Statistics& statistics) {
  ByteWriter body;
  body.put(statistics.messages);
  body.put(statistics.schemas);
  body.put(statistics.channels);
  body.put(statistics.attachments);
  body.put(statistics.metadata);
  body.put(statistics.chunks);
  body.put_time(statistics.first_time_ns);
  body.put_time(statistics.last_time_ns);
  body.put_map(statistics.messages_of_channel);
  return record(Op::statistics, body);
}

}  // namespace

Writer::Writer(const std::string& path, const WriterOptions& options) : options_(options), file_(path) {
  ByteWriter body;
  body.put_string(options_.profile);
  body.put_string(options_.library);
  file_.append(kMagic);
  file_.append(record(Op::header, body));
}

Writer::~Writer() {
  try {
    close();
  } catch (
      const std::exception&) {  // NOLINT(bugprone-empty-catch): a destructor cannot report it; close() does
  }
}

std::uint16_t Writer::add_schema(const std::string& name, const std::string& encoding,
                                 const std::string& text) {
  schemas_.push_back({static_cast<std::uint16_t>(schemas_.size() + 1), name, encoding, text});
  ++statistics_.schemas;
  return schemas_.back().id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema_id, const std::string& topic,
                                  const std::string& message_encoding, const StringMap& metadata) {
  if (schema_id > schemas_.size()) throw std::runtime_error(topic + ": its schema was not added");
  channels_.push_back(
      {static_cast<std::uint16_t>(channels_.size()), schema_id, topic, message_encoding, metadata});
  ++statistics_.channels;
  return channels_.back().id;
}

/// A reader finds a channel before its first message in every chunk: without the index, and beside a chunk
/// that is damaged.
void Writer::introduce(std::uint16_t channel_id) {
  if (!introduced_channels_.insert(channel_id).second) return;
  const Channel& channel = channels_.at(channel_id);
  if (channel.schema_id != 0 && introduced_schemas_.insert(channel.schema_id).second) {
    chunk_.put_raw(record_of(schemas_[channel.schema_id - 1u]));
  }
  chunk_.put_raw(record_of(channel));
}

void Writer::write(const Message& message) {
  if (message.channel_id >= channels_.size()) throw std::runtime_error("a message of a channel never added");
  if (chunk_messages_.empty()) chunk_first_ns_ = chunk_last_ns_ = message.log_time_ns;
  chunk_first_ns_ = std::min(chunk_first_ns_, message.log_time_ns);
  chunk_last_ns_ = std::max(chunk_last_ns_, message.log_time_ns);
  introduce(message.channel_id);
  chunk_messages_[message.channel_id].push_back({message.log_time_ns, chunk_.bytes().size()});
  chunk_.put(static_cast<std::uint8_t>(Op::message));
  chunk_.put(static_cast<std::uint64_t>(message.data.size() + 22));
  chunk_.put(message.channel_id);
  chunk_.put(message.sequence);
  chunk_.put_time(message.log_time_ns);
  chunk_.put_time(message.publish_time_ns);
  chunk_.put_raw(message.data);

  statistics_.first_time_ns = statistics_.messages == 0
                                  ? message.log_time_ns
                                  : std::min(statistics_.first_time_ns, message.log_time_ns);
  statistics_.last_time_ns = std::max(statistics_.last_time_ns, message.log_time_ns);
  ++statistics_.messages;
  ++statistics_.messages_of_channel[message.channel_id];
  if (chunk_.bytes().size() >= options_.chunk_bytes) flush();
}

void Writer::flush() {
  if (chunk_messages_.empty()) return;
  const Bytes compressed = compress(chunk_.bytes(), options_.compression, options_.level);
  ChunkIndex index;
  index.first_time_ns = chunk_first_ns_;
  index.last_time_ns = chunk_last_ns_;
  index.start = file_.size();
  index.compressed_size = compressed.size();
  index.uncompressed_size = chunk_.bytes().size();
  ByteWriter body;
  body.put_time(index.first_time_ns);
  body.put_time(index.last_time_ns);
  body.put(index.uncompressed_size);
  body.put(crc32(chunk_.bytes()));
  body.put_string(name(options_.compression));
  body.put(index.compressed_size);
  body.put_raw(compressed);
  const Bytes whole = record(Op::chunk, body);
  index.length = whole.size();
  file_.append(whole);
  write_message_indexes(index);
  chunks_.push_back(std::move(index));
  ++statistics_.chunks;
  chunk_.clear();
  chunk_messages_.clear();
  introduced_channels_.clear();
  introduced_schemas_.clear();
}

void Writer::write_message_indexes(ChunkIndex& chunk) {
  ByteWriter out;
  for (const auto& [channel_id, messages] : chunk_messages_) {
    chunk.message_index_starts[channel_id] = file_.size() + out.bytes().size();
    ByteWriter body;
    body.put(channel_id);
    body.put(static_cast<std::uint32_t>(messages.size() * 16));
    for (const MessageAt& message : messages) {
      body.put_time(message.time_ns);
      body.put(message.offset);
    }
    put_record(out, Op::message_index, body.bytes());
  }
  chunk.message_index_length = out.bytes().size();
  file_.append(out.bytes());
}

void Writer::attach(const Attachment& attachment) {
  flush();
  ByteWriter body;
  body.put_time(attachment.log_time_ns);
  body.put_time(attachment.create_time_ns);
  body.put_string(attachment.name);
  body.put_string(attachment.media_type);
  body.put(static_cast<std::uint64_t>(attachment.data.size()));
  body.put_raw(attachment.data);
  body.put(crc32(body.bytes()));
  const Bytes whole = record(Op::attachment, body);
  ByteWriter index;
  index.put(file_.size());
  index.put(static_cast<std::uint64_t>(whole.size()));
  index.put_time(attachment.log_time_ns);
  index.put_time(attachment.create_time_ns);
  index.put(static_cast<std::uint64_t>(attachment.data.size()));
  index.put_string(attachment.name);
  index.put_string(attachment.media_type);
  attachment_indexes_.push_back(record(Op::attachment_index, index));
  file_.append(whole);
  ++statistics_.attachments;
}

void Writer::write_metadata(const Metadata& metadata) {
  flush();
  ByteWriter body;
  body.put_string(metadata.name);
  body.put_map(metadata.entries);
  const Bytes whole = record(Op::metadata, body);
  ByteWriter index;
  index.put(file_.size());
  index.put(static_cast<std::uint64_t>(whole.size()));
  index.put_string(metadata.name);
  metadata_indexes_.push_back(record(Op::metadata_index, index));
  file_.append(whole);
  ++statistics_.metadata;
}

void Writer::begin_group() { group_start_ = file_.size(); }

void Writer::end_group(Op op) {
  const std::uint64_t length = file_.size() - group_start_;
  if (length == 0) return;
  ByteWriter body;
  body.put(static_cast<std::uint8_t>(op));
  body.put(group_start_);
  body.put(length);
  summary_offsets_.push_back(record(Op::summary_offset, body));
}

void Writer::write_summary() {
  begin_group();
  for (const Schema& schema : schemas_) file_.append(record_of(schema));
  end_group(Op::schema);
  begin_group();
  for (const Channel& channel : channels_) file_.append(record_of(channel));
  end_group(Op::channel);
  begin_group();
  file_.append(record_of(statistics_));
  end_group(Op::statistics);
  begin_group();
  for (const ChunkIndex& chunk : chunks_) {
    ByteWriter body;
    body.put_time(chunk.first_time_ns);
    body.put_time(chunk.last_time_ns);
    body.put(chunk.start);
    body.put(chunk.length);
    body.put_map(chunk.message_index_starts);
    body.put(chunk.message_index_length);
    body.put_string(name(options_.compression));
    body.put(chunk.compressed_size);
    body.put(chunk.uncompressed_size);
    file_.append(record(Op::chunk_index, body));
  }
  end_group(Op::chunk_index);
  begin_group();
  for (const Bytes& index : attachment_indexes_) file_.append(index);
  end_group(Op::attachment_index);
  begin_group();
  for (const Bytes& index : metadata_indexes_) file_.append(index);
  end_group(Op::metadata_index);
}

void Writer::close() {
  if (closed_) return;
  closed_ = true;
  flush();
  ByteWriter end_of_data;
  end_of_data.put(file_.sum());
  file_.append(record(Op::data_end, end_of_data));
  const std::uint64_t summary_start = file_.size();
  file_.restart_sum();
  write_summary();
  const std::uint64_t offsets_start = file_.size();
  for (const Bytes& offset : summary_offsets_) file_.append(offset);
  ByteWriter footer;  // its checksum covers the footer up to the checksum
  footer.put(static_cast<std::uint8_t>(Op::footer));
  footer.put(std::uint64_t{20});
  footer.put(summary_start);
  footer.put(offsets_start);
  footer.put(crc32(footer.bytes(), file_.sum()));
  footer.put_raw(kMagic);
  file_.append(footer.bytes());
}

}  // namespace stilt::mcap
