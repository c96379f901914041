#include "firmware/diagnostics/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace stilt::diagnostics {

std::string why_not_writable(const std::string& path) {
  if (path.empty() || path == "-") return {};
  const std::filesystem::path file(path);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) return std::strerror(EISDIR);
  const bool replaces = std::filesystem::exists(file, ignored);
  return access(replaces ? file.c_str() : folder.c_str(), W_OK) == 0 ? "" : std::strerror(errno);
}

std::expected<void, std::string> write_file(const std::string& path, std::string_view text) {
  const bool standard_output = path == "-";
  errno = 0;
  std::FILE* stream = standard_output ? stdout : std::fopen(path.c_str(), "w");
  if (stream == nullptr) return std::unexpected(std::strerror(errno));
  const bool all = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  const bool flushed = std::fflush(stream) == 0;
  const std::string reason = std::strerror(errno);
  const bool closed = standard_output || std::fclose(stream) == 0;
  if (all && flushed && closed) return {};
  return std::unexpected(all && flushed ? std::strerror(errno) : reason);
}

}  // namespace stilt::diagnostics
