#pragma once

#include <string>

#include "host_tools/recording/mcap/crc32.h"
#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// A file that grows by whole pieces, without a buffer of this process in between: what append() returned
/// from survives its death.
class OutputFile {
 public:
  /// Makes the file, or empties it. Throws when it cannot.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws when the file cannot be written any further.
  void append(ByteView data);

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// Sum of all bytes since the last restart_sum(), see crc32().
  [[nodiscard]] std::uint32_t sum() const { return sum_; }
  void restart_sum() { sum_ = 0; }

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t sum_ = 0;
};

}  // namespace stilt::mcap
