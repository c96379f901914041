#include "hal/robot/node_identifiers.h"

#include <bit>
#include <cstdio>

#include "hal/mit/damiao_registers.h"

namespace stilt::hal {
namespace {

constexpr std::uint32_t kOdriveCommands = 32;  // a node
constexpr std::uint32_t kOdriveMask = kMaximumStandardId & ~(kOdriveCommands - 1);
constexpr std::uint32_t kOdriveEverybody = 0x3f;
constexpr std::uint32_t kMoteusReplyWanted = 0x8000;
/// Destination, and the prefix above source and destination, which is 0.
constexpr std::uint32_t kMoteusHeard = 0x1fff00ff;

NodeIdentifiers of(const protocol::MitDriver& driver) {
  const IdPattern command{.value = driver.command_id};
  NodeIdentifiers node{{command}, {command}, {{.value = driver.reply_id}}, driver.layout};
  if (driver.layout == protocol::ReplyLayout::damiao) {
    node.hears.push_back({.value = protocol::kDamiaoRegisterId});
  }
  return node;
}

NodeIdentifiers of(const protocol::MoteusDriver& driver) {
  const std::uint32_t command =
      kMoteusReplyWanted | static_cast<std::uint32_t>(driver.source) << 8 | driver.id;
  const std::uint32_t reply = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  const bool long_reply = reply > kMaximumStandardId;
  return {{{.value = command, .standard = false, .extended = true}},
          {{.value = driver.id, .mask = kMoteusHeard, .standard = true, .extended = true}},
          {{.value = reply, .standard = !long_reply, .extended = long_reply}},
          std::nullopt};
}

NodeIdentifiers of(const OdriveNode& driver) {
  const IdPattern own{.value = driver.node * kOdriveCommands, .mask = kOdriveMask};
  const IdPattern everybody{.value = kOdriveEverybody * kOdriveCommands, .mask = kOdriveMask};
  return {{own}, {own, everybody}, {own}, std::nullopt};
}

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

NodeIdentifiers identifiers(const JointWiring& joint) {
  return std::visit([](const auto& driver) { return of(driver); }, joint.driver);
}

NodeIdentifiers identifiers(const protocol::ChannelRow& channel) {
  const IdPattern frame{.value = channel.id, .standard = !channel.extended, .extended = channel.extended};
  return {{}, {}, {frame}, std::nullopt};
}

std::vector<IdCollision> collisions(const NodeIdentifiers& a, const NodeIdentifiers& b) {
  std::vector<IdCollision> found;
  const bool told_apart = a.named_senders && a.named_senders == b.named_senders;
  if (!told_apart) find(a.sends, b.sends, found);
  find(a.sends, b.hears, found);
  find(a.hears, b.sends, found);
  find(a.commands, b.hears, found);
  find(a.hears, b.commands, found);
  return found;
}

}  // namespace stilt::hal
