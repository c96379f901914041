#pragma once

#include <string>

#include "host_tools/recording/mcap/crc32.h"
#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// A file that grows by whole pieces, without a buffer in this process. After append() returns, the piece
/// survives a crash of the process.
class OutputFile {
 public:
  /// Throws std::runtime_error, one sentence, where the name is that of a file with content.
  static void require_new(const std::string& path);

  /// Creates the file. Throws when it cannot, when there is one with content, and when another process
  /// writes to it. Devices and FIFOs are written to as they are.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws when the piece cannot be written.
  void append(ByteView data);

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// CRC-32 of all bytes since the last restart_sum(), see crc32().
  [[nodiscard]] std::uint32_t sum() const { return sum_; }
  void restart_sum() { sum_ = 0; }

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t sum_ = 0;
};

}  // namespace stilt::mcap
