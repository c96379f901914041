#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "host_tools/recording/schema/message_types.h"

namespace stilt::schema {

/// Decodes a message of any type to JSON, with its fields in order. Non-finite numbers are kept. Throws
/// std::runtime_error when the bytes are not a message of that type.
/// @param cdr  with the four bytes of the encoding; little endian, plain CDR
[[nodiscard]] nlohmann::ordered_json decode(const MessageTypes& types, const std::string& name,
                                            std::span<const std::uint8_t> cdr);

}  // namespace stilt::schema
