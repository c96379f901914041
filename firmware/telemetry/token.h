#pragma once

#include <cstdint>
#include <expected>
#include <string>

/// What proves that a command comes from somebody who may read a file of the robot.
namespace stilt::telemetry {

/// Where the token is: `configured`, or for "auto" $XDG_RUNTIME_DIR/stilt/token-DOMAIN, without that variable
/// /tmp/stilt-UID/token-DOMAIN.
[[nodiscard]] std::string token_path(const std::string& configured, int domain);

/// Writes a new random token (128 bits, hexadecimal) to the file, readable by its owner alone, and returns
/// it. The error is one sentence for the user.
[[nodiscard]] std::expected<std::string, std::string> write_token(const std::string& path);

/// The token in the file: its first line, at least 16 characters, of a file that its owner alone may read.
[[nodiscard]] std::expected<std::string, std::string> read_token(const std::string& path);

/// A random number of a run of stiltd, 1 to 2^53 - 1, which JavaScript holds exactly.
[[nodiscard]] std::uint64_t random_run_id();

}  // namespace stilt::telemetry
