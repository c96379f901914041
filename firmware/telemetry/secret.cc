#include "firmware/telemetry/secret.h"

#include <nettle/base16.h>
#include <nettle/hmac.h>
#include <nettle/memops.h>
#include <sys/random.h>

#include <array>
#include <bit>
#include <span>

// Why nettle: docs/decisions/0020-one-commander.md
namespace stilt::telemetry {
namespace {

constexpr std::size_t kSecret_bytes = 16;

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  std::string text(BASE16_ENCODE_LENGTH(bytes.size()), '\0');
  base16_encode_update(text.data(), bytes.size(), bytes.data());
  return text;
}

void append_big_endian(std::string& bytes, std::uint64_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0;) bytes.push_back(static_cast<char>(value >> (8 * i)));
}

/// A length in front keeps neighbouring texts apart.
void append_text(std::string& bytes, std::string_view text) {
  append_big_endian(bytes, text.size(), 8);
  bytes += text;
}

}  // namespace

std::string random_secret() {
  std::array<std::uint8_t, kSecret_bytes> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
  return hexadecimal(bytes);
}

bool same_secret(std::string_view given, std::string_view secret) noexcept {
  return !secret.empty() && given.size() == secret.size() &&
         memeql_sec(given.data(), secret.data(), secret.size()) != 0;
}

std::string hmac_sha256(std::string_view key, std::string_view text) {
  hmac_sha256_ctx context;
  hmac_sha256_set_key(&context, key.size(), reinterpret_cast<const std::uint8_t*>(key.data()));
  hmac_sha256_update(&context, text.size(), reinterpret_cast<const std::uint8_t*>(text.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  hmac_sha256_digest(&context, digest.size(), digest.data());
  return hexadecimal(digest);
}

std::string proof(std::string_view token, const CommandText& command) {
  std::string text;
  append_big_endian(text, command.run_id, 8);
  append_text(text, command.commander);
  append_big_endian(text, command.number, 8);
  append_big_endian(text, command.kind, 1);
  append_big_endian(text, std::bit_cast<std::uint64_t>(command.value), 8);
  append_text(text, command.key);
  return "hmac-sha256:" + hmac_sha256(token, text);
}

std::string proof(std::string_view token, const ReplyText& reply) {
  std::string text;
  append_big_endian(text, reply.run_id, 8);
  append_text(text, reply.commander);
  append_big_endian(text, reply.number, 8);
  append_big_endian(text, reply.accepted ? 1 : 0, 1);
  append_text(text, reply.reason);
  append_big_endian(text, std::bit_cast<std::uint64_t>(reply.time_s), 8);
  return "hmac-sha256:" + hmac_sha256(hmac_sha256(token, "reply"), text);
}

}  // namespace stilt::telemetry
