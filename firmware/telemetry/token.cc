#include "firmware/telemetry/token.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>

#include "firmware/telemetry/secret.h"

namespace stilt::telemetry {
namespace {

constexpr std::size_t kShortestToken = 16;
constexpr std::size_t kLongestToken = 256;
constexpr mode_t kOwnerOnly = 0600;
constexpr unsigned kOfOthers = 077;

std::string unreadable(const std::string& path, const std::string& why) {
  return "token file " + path + ": " + why;
}

/// Hexadecimal, base64 and its form for addresses. Other secrets, such as passwords with their user's name in
/// front, mostly have other characters.
bool is_token(const std::string& text) {
  constexpr std::string_view kCharacters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=-_";
  return text.size() >= kShortestToken && text.size() <= kLongestToken &&
         text.find_first_not_of(kCharacters) == std::string::npos;
}

std::string failure(const std::string& path, const std::string& what) {
  return "token file " + path + ": " + what + "; name another one in telemetry.token_file";
}

/// A folder of our own: no other user may put files there.
std::string make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) {
    struct stat status{};
    const bool others_may_write = stat(folder.c_str(), &status) != 0 || (status.st_mode & 022) != 0;
    const bool sticky = (status.st_mode & S_ISVTX) != 0;
    if (others_may_write && !sticky) return "others may write to its folder";
    return status.st_uid == geteuid() || status.st_uid == 0 ? "" : "its folder belongs to somebody else";
  }
  std::filesystem::create_directories(folder.parent_path(), error);
  return mkdir(folder.c_str(), 0700) == 0 ? "" : std::strerror(errno);
}

/// The lock names the process that has it.
std::string held_by_another(const std::string& path, int lock) {
  std::array<char, 16> process{};
  const ssize_t size = pread(lock, process.data(), process.size(), 0);
  std::string number(process.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  number = number.substr(0, number.find('\n'));
  return "stiltd runs already with the token file " + path +
         (number.empty() ? "" : ", as process " + number) +
         "; end it, or give this one a telemetry.domain of its own, and a telemetry.token_file where that is "
         "set";
}

}  // namespace

std::string token_path(const std::string& configured, int domain) {
  if (configured != "auto") return configured;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  const std::string folder = runtime != nullptr && *runtime == '/'
                                 ? std::string(runtime) + "/stilt"
                                 : "/tmp/stilt-" + std::to_string(geteuid());
  return folder + "/token-" + std::to_string(domain);
}

TokenFile::File TokenFile::open(const std::string& path, int flags, const char* mode) {
  const int number = ::open(path.c_str(), flags | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kOwnerOnly);
  return File(number < 0 ? nullptr : fdopen(number, mode));
}

std::expected<TokenFile, std::string> TokenFile::hold(const std::string& path) {
  const std::string wrong = make_folder(std::filesystem::path(path).parent_path());
  if (!wrong.empty()) return std::unexpected(failure(path, wrong));
  const std::string lock_path = path + ".lock";
  File lock = open(lock_path, O_RDWR, "r+");
  if (!lock) return std::unexpected(failure(lock_path, std::strerror(errno)));
  const int number = fileno(lock.get());
  if (flock(number, LOCK_EX | LOCK_NB) != 0) return std::unexpected(held_by_another(path, number));
  const bool named = ftruncate(number, 0) == 0 && std::fprintf(lock.get(), "%d\n", getpid()) > 0 &&
                     std::fflush(lock.get()) == 0;
  if (!named) return std::unexpected(failure(lock_path, "cannot be written"));
  return TokenFile(path, std::move(lock));
}

std::expected<std::string, std::string> TokenFile::write() const {
  std::string token = random_secret();
  // Made beside its place and moved there: a reader finds the old one or the new one.
  const std::string beside = path_ + '.' + std::to_string(getpid());
  unlink(beside.c_str());
  const File file = open(beside, O_WRONLY | O_EXCL, "w");
  if (!file) return std::unexpected(failure(path_, std::strerror(errno)));
  const bool written = std::fprintf(file.get(), "%s\n", token.c_str()) > 0 && std::fflush(file.get()) == 0;
  if (written && !token.empty() && rename(beside.c_str(), path_.c_str()) == 0) return token;
  unlink(beside.c_str());
  return std::unexpected(failure(path_, "cannot be written"));
}

std::expected<std::string, std::string> read_token(const std::string& path) {
  // The path may come from the network: neither a FIFO nor a device may stop this thread.
  const int number = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  const std::string why_not = number < 0 ? std::strerror(errno) : "";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(number < 0 ? nullptr : fdopen(number, "r"),
                                                             &std::fclose);
  struct stat status{};
  if (!file || fstat(number, &status) != 0) {
    return std::unexpected(unreadable(path, why_not + "; stiltd prints where its token is, and with "
                                                      "telemetry.fixed_token it reads yours"));
  }
  if (!S_ISREG(status.st_mode)) return std::unexpected(unreadable(path, "it is no regular file"));
  if (status.st_uid != geteuid() && status.st_uid != 0) {
    return std::unexpected(unreadable(path, "it belongs to another user; run as the user of stiltd"));
  }
  if ((status.st_mode & kOfOthers) != 0) {
    return std::unexpected(unreadable(path, "others may read or write it; chmod 600 makes it yours alone"));
  }
  std::string text(kLongestToken + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  std::string token = text.substr(0, text.find('\n'));
  if (is_token(token)) return token;
  return std::unexpected(unreadable(
      path, "its first line is no token of 16 to 256 characters, which are letters, digits, + / = - or _"));
}

std::uint64_t random_run_id() {
  std::uint64_t run_id = 0;
  while (run_id == 0) {
    if (getrandom(&run_id, sizeof run_id, 0) != static_cast<ssize_t>(sizeof run_id)) return 1;
    run_id &= (std::uint64_t{1} << 53) - 1;
  }
  return run_id;
}

}  // namespace stilt::telemetry
