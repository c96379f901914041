#include "host_tools/experiments/text_hash.h"

#include <cinttypes>
#include <cstdint>
#include <cstdio>

namespace stilt::experiments {

std::string text_hash(std::string_view text) {
  constexpr std::uint64_t kStart = 0xcbf29ce484222325;
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t hash = kStart;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * kPrime;
  char digits[17];
  (void)std::snprintf(digits, sizeof digits, "%016" PRIx64, hash);
  return digits;
}

}  // namespace stilt::experiments
