#pragma once

#include <cstdint>

#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// CRC-32 of zlib and Ethernet (reflected polynomial 0xEDB88320). `before`: checksum of the preceding bytes.
[[nodiscard]] std::uint32_t crc32(ByteView data, std::uint32_t before = 0);

}  // namespace stilt::mcap
