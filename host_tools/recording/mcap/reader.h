#pragma once

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "host_tools/recording/mcap/byte_order.h"
#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// A message with what it belongs to. Valid until the next one is taken.
struct ReadMessage {
  const Channel* channel = nullptr;
  const Schema* schema = nullptr;  ///< null: the channel names none
  Message message;
};

/// Reads a file from front to end, as far as it is whole: one that was cut off gives everything up to its
/// last whole record. Uses no index.
class Reader {
 public:
  /// Throws when the file cannot be read or is no MCAP file.
  explicit Reader(const std::string& path);

  /// The next message in the order of the file; null at the end.
  [[nodiscard]] const ReadMessage* next();

  /// All channels, attachments and metadata met so far.
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  [[nodiscard]] const std::vector<Attachment>& attachments() const { return attachments_; }
  [[nodiscard]] const std::vector<Metadata>& metadata() const { return metadata_; }

  /// After the end: the file was closed in order.
  [[nodiscard]] bool complete() const { return complete_; }
  /// What is wrong with the file, a sentence each; a file that was cut off has one.
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
  void end(const std::string& problem);
  [[noreturn]] void refuse(const std::string& why) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;  ///< of the next record
  Bytes body_;            ///< of the newest record
  Bytes chunk_;           ///< records of the open chunk
  std::uint64_t chunk_at_ = 0;
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
