#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "host_tools/recording/schema/message_types.h"

namespace stilt::schema {

/// A message of any type as JSON, its fields in their order. Numbers that are not finite stay what they are.
/// Throws std::runtime_error when the bytes are not a message of that type.
/// @param cdr  with the four bytes that name the encoding; little endian, plain CDR
[[nodiscard]] nlohmann::ordered_json decode(const MessageTypes& types, const std::string& name,
                                            std::span<const std::uint8_t> cdr);

}  // namespace stilt::schema
