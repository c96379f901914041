#pragma once

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "host_tools/recording/mcap/byte_order.h"
#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// A message with its channel and schema. Valid until the next call of next().
struct ReadMessage {
  const Channel* channel = nullptr;
  const Schema* schema = nullptr;  ///< null: the channel has none
  Message message;
};

/// Reads a file from beginning to end without its index. A file that was cut off is read up to its last
/// complete record.
class Reader {
 public:
  /// Throws when the file cannot be read or is not an MCAP file.
  explicit Reader(const std::string& path);

  /// The next message in the order of the file; null at the end.
  [[nodiscard]] const ReadMessage* next();

  /// All channels, attachments and metadata met so far.
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  [[nodiscard]] const std::vector<Attachment>& attachments() const { return attachments_; }
  [[nodiscard]] const std::vector<Metadata>& metadata() const { return metadata_; }

  /// At the end of the file: whether it was closed properly.
  [[nodiscard]] bool complete() const { return complete_; }
  /// Defects of the file, one sentence each; a file that was cut off has one.
  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

 private:
  [[nodiscard]] bool read_record();
  void take_record(Op op, ByteView body);
  void take_chunk(ByteView body);
  void take_schema(ByteReader body);
  void take_channel(ByteReader body);
  void take_attachment(ByteView body);
  void take_metadata(ByteReader body);
  void take_message(ByteReader body);
  [[nodiscard]] bool next_in_chunk();
  void take_record_of_chunk();
  void end(const std::string& problem);
  [[noreturn]] void refuse(const std::string& why) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;  ///< of the next record
  Bytes body_;            ///< of the record read last
  Bytes chunk_;           ///< records of the open chunk
  std::size_t chunk_at_ = 0;
  bool chunk_reported_ = false;
  bool has_message_ = false;
  bool ended_ = false;
  bool complete_ = false;
  ReadMessage message_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<Attachment> attachments_;
  std::vector<Metadata> metadata_;
  std::vector<std::string> problems_;
};

}  // namespace stilt::mcap
