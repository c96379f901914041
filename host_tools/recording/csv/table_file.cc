#include "host_tools/recording/csv/table_file.h"

#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <system_error>

#include "firmware/diagnostics/output_file.h"

namespace stilt::csv {
namespace {

namespace fs = std::filesystem;

/// A file of no other process beside `target`; empty where that one is written to as it is.
fs::path name_beside(const fs::path& target) {
  static std::atomic<unsigned> count = 0;
  std::error_code ignored;
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) return {};
  const std::string name = ".table-" + std::to_string(getpid()) + "-" + std::to_string(count++);
  return (target.has_parent_path() ? target.parent_path() : ".") / name;
}

}  // namespace

TableFile::TableFile(const std::string& path) : path_(path) {
  std::error_code error;
  target_ = fs::weakly_canonical(path, error);
  if (error) target_ = path;
  beside_ = name_beside(target_);
  std::error_code ignored;
  if (!beside_.empty()) fs::remove(beside_, ignored);  // of a process of the same number that was cut off
  text_.open(beside_.empty() ? target_ : beside_, std::ios::binary);
  if (!text_) throw std::runtime_error(path + ": cannot be written; name a file in a folder that exists");
}

TableFile::~TableFile() {
  std::error_code ignored;
  if (!beside_.empty()) fs::remove(beside_, ignored);
}

void TableFile::close() {
  text_.close();
  if (text_ && (beside_.empty() || diagnostics::wait_for_disk(beside_.string()))) return;
  throw std::runtime_error(path_ + ": cannot be written any further; is there room on the disk?");
}

void TableFile::place() {
  if (beside_.empty()) return;
  std::error_code ignored, error;
  const fs::file_status old = fs::status(target_, ignored);
  if (fs::exists(old)) fs::permissions(beside_, old.permissions(), ignored);
  fs::rename(beside_, target_, error);
  if (error) throw std::runtime_error(path_ + ": cannot be replaced (" + error.message() + ")");
  beside_.clear();
}

}  // namespace stilt::csv
