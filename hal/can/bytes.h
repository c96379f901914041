#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

namespace stilt::hal {

inline constexpr double kRadiansPerRevolution = 2 * std::numbers::pi;

/// Little-endian unsigned integer of 1 to 8 bytes. The caller has checked the length. Real-time safe.
[[nodiscard]] constexpr std::uint64_t load_little(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

constexpr void store_little(std::span<std::uint8_t> bytes, std::uint64_t value) noexcept {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value & 0xff);
    value >>= 8;
  }
}

/// The low `bits` bits as two's complement, 1 <= bits <= 64.
[[nodiscard]] constexpr std::int64_t sign_extend(std::uint64_t value, unsigned bits) noexcept {
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  const std::uint64_t mask = sign | (sign - 1);
  return std::bit_cast<std::int64_t>(((value & mask) ^ sign) - sign);
}

[[nodiscard]] constexpr float load_float(std::span<const std::uint8_t> four_bytes) noexcept {
  return std::bit_cast<float>(static_cast<std::uint32_t>(load_little(four_bytes)));
}

constexpr void store_float(std::span<std::uint8_t> four_bytes, float value) noexcept {
  store_little(four_bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace stilt::hal
