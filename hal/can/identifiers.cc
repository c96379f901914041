#include "hal/can/identifiers.h"

#include <bit>
#include <cstdio>

namespace stilt::hal {
namespace {

void find(const std::vector<IdPattern>& first, const std::vector<IdPattern>& second,
          std::vector<IdCollision>& found) {
  for (const IdPattern& a : first) {
    for (const IdPattern& b : second) {
      if (overlap(a, b)) found.push_back({a, b});
    }
  }
}

}  // namespace

bool overlap(const IdPattern& a, const IdPattern& b) noexcept {
  const bool same_length = (a.standard && b.standard) || (a.extended && b.extended);
  return same_length && ((a.value ^ b.value) & a.mask & b.mask) == 0;
}

std::string describe(const IdPattern& pattern) {
  char text[80];
  const std::uint32_t free_bits =
      ~pattern.mask & (pattern.extended ? kMaximumExtendedId : kMaximumStandardId);
  if (free_bits == 0) {
    std::snprintf(text, sizeof text, "identifier 0x%x", pattern.value);
  } else if (std::has_single_bit(free_bits + 1)) {
    std::snprintf(text, sizeof text, "identifiers 0x%x to 0x%x", pattern.value, pattern.value | free_bits);
  } else {
    std::snprintf(text, sizeof text, "identifiers that end in the %d bits 0x%x",
                  std::countr_one(pattern.mask), pattern.value);
  }
  return text;
}

std::vector<IdCollision> collisions(const NodeIdentifiers& a, const NodeIdentifiers& b) {
  std::vector<IdCollision> found;
  const bool distinguished = !a.sender_format.empty() && a.sender_format == b.sender_format;
  if (!distinguished) find(a.sends, b.sends, found);
  find(a.sends, b.accepts, found);
  find(a.accepts, b.sends, found);
  find(a.commands, b.accepts, found);
  find(a.accepts, b.commands, found);
  return found;
}

}  // namespace stilt::hal
