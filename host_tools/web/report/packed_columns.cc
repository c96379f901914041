#include "host_tools/web/report/packed_columns.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

namespace stilt::report {

std::string encode_base64(std::span<const unsigned char> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k) triple = triple << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[triple >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return text;
}

void PackedColumns::append(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const float rounded = std::abs(value) > kLargest ? std::copysign(std::numeric_limits<float>::infinity(),
                                                                   static_cast<float>(value > 0.0 ? 1 : -1))
                                                   : static_cast<float>(value);
  const auto bits = std::bit_cast<std::uint32_t>(rounded);
  for (int shift = 0; shift < 32; shift += 8)
    bytes_.push_back(static_cast<unsigned char>(bits >> shift & 255u));
}

nlohmann::ordered_json PackedColumns::json() const {
  return {{"rows", rows_}, {"groups", groups_}, {"float32_base64", encode_base64(bytes_)}};
}

}  // namespace stilt::report
