#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace stilt::csv {

/// A file that takes its name once it is whole. Its text goes to a file beside it. Without place() that one
/// is removed, and an earlier file of the name stays. Devices and FIFOs are written to as they are; a
/// symbolic link and permissions stay.
class TableFile {
 public:
  /// Throws std::runtime_error, one sentence, when the file cannot be written.
  explicit TableFile(const std::string& path);
  ~TableFile();
  TableFile(const TableFile&) = delete;
  TableFile& operator=(const TableFile&) = delete;

  [[nodiscard]] std::ostream& text() { return text_; }

  /// The end of the text, to the disk. Throws std::runtime_error, one sentence, when a part was not written.
  void close();

  /// Gives the closed file its name. Throws std::runtime_error, one sentence, when that cannot be.
  void place();

 private:
  std::string path_;
  std::filesystem::path target_;  ///< the file that a symbolic link stands for
  std::filesystem::path beside_;  ///< the file while it is written; empty: the target itself
  std::ofstream text_;
};

}  // namespace stilt::csv
