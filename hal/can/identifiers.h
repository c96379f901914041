#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/can/frame.h"

/// Which CAN identifiers a node uses, so that two nodes of a bus do not use the same. At start-up only.
namespace stilt::hal {

/// Identifiers whose bits under `mask` are those of `value`.
struct IdPattern {
  std::uint32_t value = 0;
  std::uint32_t mask = kMaximumExtendedId;  ///< all bits: one identifier
  bool standard = true;                     ///< among those of 11 bits
  bool extended = false;                    ///< among those of 29 bits
};

/// Whether an identifier fits both.
[[nodiscard]] bool overlap(const IdPattern& a, const IdPattern& b) noexcept;

/// "identifier 0x50", "identifiers 0x40 to 0x5f", "identifiers that end in the 8 bits 0x1".
[[nodiscard]] std::string describe(const IdPattern& pattern);

/// Identifiers that a node uses, by direction.
struct NodeIdentifiers {
  std::vector<IdPattern> commands;  ///< we send them to this node
  std::vector<IdPattern> accepts;   ///< taken as meant for it, from any sender
  std::vector<IdPattern> sends;     ///< it sends them to us
  /// Name of a frame format that says who sent it: other nodes of that format may send the same identifier.
  /// Empty: none.
  std::string sender_format;
};

/// A frame that fits both may be misunderstood.
struct IdCollision {
  IdPattern first;
  IdPattern second;
};

/// All collisions of two nodes on one bus: `first` of node a, `second` of node b.
[[nodiscard]] std::vector<IdCollision> collisions(const NodeIdentifiers& a, const NodeIdentifiers& b);

}  // namespace stilt::hal
