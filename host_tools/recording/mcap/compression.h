#pragma once

#include <string>
#include <string_view>

#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

enum class Compression { none, lz4, zstd };

/// The name of a compression in a file: empty, lz4, zstd.
[[nodiscard]] std::string_view name(Compression compression);

/// The compression with that name. Throws std::runtime_error for an unknown name.
[[nodiscard]] Compression compression_named(std::string_view name);

/// Compresses to one frame of the compression's own format.
[[nodiscard]] Bytes compress(ByteView data, Compression compression, int level);

/// The inverse of compress(). Throws std::runtime_error when `data` is damaged or does not give `size` bytes,
/// or when `size` is above 1 GiB.
[[nodiscard]] Bytes decompress(ByteView data, Compression compression, std::uint64_t size);

}  // namespace stilt::mcap
