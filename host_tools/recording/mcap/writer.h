#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "host_tools/recording/mcap/byte_order.h"
#include "host_tools/recording/mcap/compression.h"
#include "host_tools/recording/mcap/output_file.h"
#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// Options of a Writer.
struct WriterOptions {
  std::string profile = "ros2";
  std::string library = "stilt";
  Compression compression = Compression::zstd;
  int level = 1;
  std::size_t chunk_bytes = 4u << 20;  ///< a chunk is written when it reaches this size
};

/// Writes one file. Messages stay in memory until their chunk is written: call flush() often. Flushed data
/// stay readable if the process crashes. close() adds index and statistics.
class Writer {
 public:
  /// Throws when the file cannot be written.
  explicit Writer(const std::string& path, const WriterOptions& options = {});
  /// Closes the file and ignores errors.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// @return  id of the schema, from 1
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& text);
  /// @return  id of the channel, from 0
  std::uint16_t add_channel(std::uint16_t schema_id, const std::string& topic,
                            const std::string& message_encoding, const StringMap& metadata = {});

  void write(const Message& message);
  /// Written at once, after the flushed data.
  void attach(const Attachment& attachment);
  void write_metadata(const Metadata& metadata);

  /// Writes the messages so far as one chunk. No effect without messages.
  void flush();

  /// Whether there are messages that are not in the file yet.
  [[nodiscard]] bool has_open_chunk() const { return !chunk_messages_.empty(); }

  /// Writes the remaining messages, index and statistics. Nothing may be written afterwards.
  void close();

  [[nodiscard]] std::uint64_t bytes_written() const { return file_.size(); }
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  struct ChunkIndex {
    std::int64_t first_time_ns = 0, last_time_ns = 0;
    std::uint64_t start = 0, length = 0;
    std::map<std::uint16_t, std::uint64_t> message_index_starts;
    std::uint64_t message_index_length = 0;
    std::uint64_t compressed_size = 0, uncompressed_size = 0;
  };
  struct MessageAt {
    std::int64_t time_ns;
    std::uint64_t offset;
  };

  void introduce(std::uint16_t channel_id);
  void write_message_indexes(ChunkIndex& chunk);
  void write_summary();
  void begin_group();
  void end_group(Op op);

  WriterOptions options_;
  OutputFile file_;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::set<std::uint16_t> introduced_channels_, introduced_schemas_;
  ByteWriter chunk_;  ///< records of the open chunk
  std::int64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::map<std::uint16_t, std::vector<MessageAt>> chunk_messages_;
  std::vector<ChunkIndex> chunks_;
  std::vector<Bytes> attachment_indexes_, metadata_indexes_;
  Statistics statistics_;
  std::vector<Bytes> summary_offsets_;
  std::uint64_t group_start_ = 0;
  bool closed_ = false;
};

}  // namespace stilt::mcap
