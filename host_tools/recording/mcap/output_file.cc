#include "host_tools/recording/mcap/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace stilt::mcap {

namespace {

bool has_content(const struct stat& status) { return S_ISREG(status.st_mode) && status.st_size > 0; }

/// Whether the file has content, or a process that writes to it and so holds its lock.
bool is_taken(int file) {
  struct stat status{};
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return true;
  return fstat(file, &status) == 0 && has_content(status);  // once more: its writer may have just gone
}

[[noreturn]] void refuse_existing(const std::string& path) {
  throw std::runtime_error(path + ": exists; name another file or remove it");
}

}  // namespace

void OutputFile::require_new(const std::string& path) {
  struct stat status{};
  if (stat(path.c_str(), &status) == 0 && has_content(status)) refuse_existing(path);
}

OutputFile::OutputFile(const std::string& path) : path_(path) {
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) {
    throw std::runtime_error(path + ": cannot be written (" + std::strerror(errno) +
                             "); name a file in a folder that exists and may be written to");
  }
  if (is_taken(file_)) {
    ::close(file_);
    refuse_existing(path);
  }
}

OutputFile::~OutputFile() { ::close(file_); }

void OutputFile::append(ByteView data) {
  for (ByteView left = data; !left.empty();) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      throw std::runtime_error(path_ + ": cannot be written any further (" + std::strerror(errno) +
                               "); make room, or name a file on another disk");
    }
    left = left.subspan(static_cast<std::size_t>(written));
  }
  sum_ = crc32(data, sum_);
  size_ += data.size();
}

}  // namespace stilt::mcap
