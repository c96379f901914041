#include "host_tools/recording/mcap/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace stilt::mcap {

OutputFile::OutputFile(const std::string& path) : path_(path) {
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) {
    throw std::runtime_error(path + ": cannot be written (" + std::strerror(errno) +
                             "); name a file in a folder that exists and may be written to");
  }
}

OutputFile::~OutputFile() { ::close(file_); }

void OutputFile::append(ByteView data) {
  sum_ = crc32(data, sum_);
  size_ += data.size();
  while (!data.empty()) {
    const ssize_t written = ::write(file_, data.data(), data.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      throw std::runtime_error(path_ + ": cannot be written any further (" + std::strerror(errno) + ")");
    }
    data = data.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace stilt::mcap
