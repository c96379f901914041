#pragma once

#include <cstdint>
#include <cstdio>
#include <expected>
#include <memory>
#include <string>
#include <utility>

/// What proves that a command comes from somebody who may read a file of the robot.
namespace stilt::telemetry {

/// Where the token is: `configured`, or for "auto" $XDG_RUNTIME_DIR/stilt/token-DOMAIN, without that variable
/// /tmp/stilt-UID/token-DOMAIN.
[[nodiscard]] std::string token_path(const std::string& configured, int domain);

/// The token file of a run. A process that holds it is the only one that writes there, until it ends. Two
/// runs with one file would replace each other's token. At start-up and on ordinary threads only.
class TokenFile {
 public:
  TokenFile() = default;

  /// Makes the file's folder when it is missing and locks PATH.lock. The error is one sentence for the user:
  /// another process holds the file, or others may write to the folder.
  [[nodiscard]] static std::expected<TokenFile, std::string> hold(const std::string& path);

  /// Writes a new random token (128 bits, hexadecimal), readable by its owner alone, and returns it. The
  /// error is one sentence for the user.
  [[nodiscard]] std::expected<std::string, std::string> write() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  TokenFile(std::string path, File lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  [[nodiscard]] static File open(const std::string& path, int flags, const char* mode);

  std::string path_;
  File lock_;
};

/// The token in the file: its first line, 16 to 256 letters, digits, + / = - or _. The file must be a regular
/// one, no symbolic link, of this user or root, which no other user may read. Never waits, whatever the path
/// names. The error is one sentence for the user.
[[nodiscard]] std::expected<std::string, std::string> read_token(const std::string& path);

/// A random number of a run of stiltd, 1 to 2^53 - 1, which JavaScript holds exactly.
[[nodiscard]] std::uint64_t random_run_id();

}  // namespace stilt::telemetry
