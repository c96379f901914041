#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Secrets, and proofs that their owner has them. Ordinary threads.
namespace stilt::telemetry {

/// 128 random bits, hexadecimal; empty when the system has none.
[[nodiscard]] std::string random_secret();

/// Compares in a time that does not reveal how many characters are equal; it reveals whether the lengths are
/// equal. False when `secret` is empty.
[[nodiscard]] bool same_secret(std::string_view given, std::string_view secret) noexcept;

/// HMAC-SHA-256 (RFC 2104, FIPS 180-4) by nettle, hexadecimal.
[[nodiscard]] std::string hmac_sha256(std::string_view key, std::string_view text);

/// What a command says, without what proves it.
struct CommandText {
  std::uint64_t run_id = 0;
  std::string_view commander;
  std::uint64_t number = 0;
  std::uint8_t kind = 0;
  double value = 0;
  std::string_view key;
};

/// Proof that the sender of this command has the token: "hmac-sha256:" and the HMAC of all fields. It
/// reveals neither the token nor the proof of another command.
[[nodiscard]] std::string proof(std::string_view token, const CommandText& command);

/// What a reply says, without its proof.
struct ReplyText {
  std::uint64_t run_id = 0;
  std::string_view commander;
  std::uint64_t number = 0;
  bool accepted = false;
  std::string_view reason;
  double time_s = 0;
};

/// Proof that the sender of this reply has the token: "hmac-sha256:" and the HMAC of all fields. Its key is
/// the HMAC of the word "reply" by the token, so that no proof of a command is one of a reply.
[[nodiscard]] std::string proof(std::string_view token, const ReplyText& reply);

}  // namespace stilt::telemetry
