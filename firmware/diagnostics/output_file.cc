#include "firmware/diagnostics/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace stilt::diagnostics {
namespace {

using std::filesystem::path;

path folder_of(const path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

/// A device, a FIFO or a socket: written to as it is. What is a file, or is not there yet, is replaced.
bool is_special(const path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored);
}

/// The file that a symbolic link stands for, so that the link stays.
path target_of(const path& file) {
  std::error_code error;
  const path target = std::filesystem::weakly_canonical(file, error);
  return error ? file : target;
}

/// Whether both names are of one file, which need not be there yet.
bool same_file(const path& a, const path& b) {
  if (is_special(a)) return false;
  std::error_code error;
  return target_of(std::filesystem::absolute(a, error)) == target_of(std::filesystem::absolute(b, error));
}

/// Of a file beside the one that is written: short, whatever the length of that one's name.
std::string temporary_name() {
  static std::atomic<unsigned> count = 0;
  return ".new-" + std::to_string(getpid()) + "-" + std::to_string(count++);
}

std::unexpected<std::string> system_error() { return std::unexpected<std::string>(std::strerror(errno)); }

using Pieces = std::function<std::string_view()>;

std::expected<void, std::string> put(std::FILE* stream, const Pieces& next) {
  errno = 0;
  for (std::string_view text = next(); !text.empty(); text = next()) {
    if (std::fwrite(text.data(), 1, text.size(), stream) != text.size()) return system_error();
  }
  if (std::fflush(stream) != 0) return system_error();
  return {};
}

std::expected<void, std::string> write_special(const std::string& name, const Pieces& next) {
  std::FILE* stream = std::fopen(name.c_str(), "w");
  if (stream == nullptr) return system_error();
  const auto written = put(stream, next);
  if (std::fclose(stream) != 0 && written) return system_error();
  return written;
}

/// Owner and permissions of the file that is replaced; those of a new one are the process's.
bool keep_attributes(int descriptor, const path& file) {
  struct stat old{};
  if (stat(file.c_str(), &old) != 0) return true;
  const bool same_owner = fchown(descriptor, old.st_uid, old.st_gid) == 0;
  return fchmod(descriptor, old.st_mode & 07777) == 0 && (same_owner || geteuid() != 0);
}

/// With the attributes of `file`, and to the disk where that is waited for.
std::expected<void, std::string> write_new(int descriptor, const path& file, const Pieces& next, bool wait) {
  std::FILE* stream = fdopen(descriptor, "w");
  if (stream == nullptr) {
    const auto error = system_error();
    close(descriptor);
    return error;
  }
  auto written = put(stream, next);
  const bool kept = keep_attributes(descriptor, file) && (!wait || fsync(descriptor) == 0);
  if (written && !kept) written = system_error();
  if (!wait) static_cast<void>(sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE));
  if (std::fclose(stream) != 0 && written) written = system_error();
  return written;
}

}  // namespace

std::string why_not_writable(const std::string& name) {
  if (name.empty() || name == "-") return {};
  const path file(name);
  struct stat status{};
  const bool is_there = stat(file.c_str(), &status) == 0;
  if (!is_there && errno != ENOENT) return std::strerror(errno);
  if (is_there && S_ISDIR(status.st_mode)) return std::strerror(EISDIR);
  if (is_there && access(file.c_str(), W_OK) != 0) return std::strerror(errno);
  if (is_special(file)) return {};
  return access(folder_of(target_of(file)).c_str(), W_OK) == 0 ? "" : std::strerror(errno);
}

std::string conflict(std::span<const NamedFile> outputs, std::span<const std::string> inputs) {
  for (auto one = outputs.begin(); one != outputs.end(); ++one) {
    if (one->path.empty()) continue;
    const std::string start = one->option + ' ' + one->path + ": ";
    for (auto other = outputs.begin(); other != one; ++other) {
      if (one->path == "-" && other->path == "-") {
        return start + "standard output is taken by " + other->option + "; name a file";
      }
      if (one->path == "-" || other->path.empty() || !same_file(one->path, other->path)) continue;
      return start + "is the file of " + other->option + ", too; name another one";
    }
    for (const std::string& input : inputs) {
      if (one->path == "-" || input.empty() || !same_file(one->path, input)) continue;
      return start + "is a file to be read; name another one";
    }
  }
  return {};
}

std::expected<void, std::string> write_file(const std::string& name, std::string_view text) {
  return write_file(name, [left = text]() mutable { return std::exchange(left, {}); });
}

std::expected<void, std::string> write_file(const std::string& name, const Pieces& next, bool wait) {
  if (name == "-") return put(stdout, next);
  if (is_special(name)) return write_special(name, next);
  const path file = target_of(name);
  const path beside = folder_of(file) / temporary_name();
  unlink(beside.c_str());  // of a process of the same number that was cut off
  const int descriptor = open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return system_error();
  auto written = write_new(descriptor, file, next, wait);
  if (written && std::rename(beside.c_str(), file.c_str()) != 0) written = system_error();
  if (!written) unlink(beside.c_str());
  return written;
}

bool wait_for_disk(const std::string& name) {
  const int descriptor = open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = fsync(descriptor) == 0;
  close(descriptor);
  return synced;
}

}  // namespace stilt::diagnostics
