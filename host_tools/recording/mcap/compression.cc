#include "host_tools/recording/mcap/compression.h"

#include <lz4frame.h>
#include <zstd.h>

#include <stdexcept>

namespace stilt::mcap {
namespace {

/// lz4 and zstd compress by at most these factors: zstd gives at most 128 KiB for a block of four bytes.
constexpr std::uint64_t kLz4Limit = 255;
constexpr std::uint64_t kZstdLimit = 32768;

/// Recorders write chunks of some megabytes.
constexpr std::uint64_t kLargestChunk_bytes = 1u << 30;

Bytes compress_zstd(ByteView data, int level) {
  Bytes out(ZSTD_compressBound(data.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), data.data(), data.size(), level);
  if (ZSTD_isError(size) != 0) throw std::runtime_error("zstd cannot compress a chunk");
  out.resize(size);
  return out;
}

Bytes compress_lz4(ByteView data, int level) {
  LZ4F_preferences_t preferences{};
  preferences.compressionLevel = level;
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  Bytes out(LZ4F_compressFrameBound(data.size(), &preferences));
  const std::size_t size = LZ4F_compressFrame(out.data(), out.size(), data.data(), data.size(), &preferences);
  if (LZ4F_isError(size) != 0) throw std::runtime_error("lz4 cannot compress a chunk");
  out.resize(size);
  return out;
}

/// @return  number of bytes written
std::size_t decompress_lz4(ByteView data, Bytes& out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  std::size_t taken = 0;
  std::size_t given = 0;
  std::size_t result = 1;
  while (result != 0 && taken < data.size()) {
    std::size_t in_size = data.size() - taken;
    std::size_t out_size = out.size() - given;
    result = LZ4F_decompress(context, out.data() + given, &out_size, data.data() + taken, &in_size, nullptr);
    if (LZ4F_isError(result) != 0 || (in_size == 0 && out_size == 0)) break;
    taken += in_size;
    given += out_size;
  }
  LZ4F_freeDecompressionContext(context);
  return result == 0 ? given : out.size() + 1;
}

}  // namespace

std::string_view name(Compression compression) {
  switch (compression) {
    case Compression::none:
      break;
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
  }
  return "";
}

Compression compression_named(std::string_view name_in_file) {
  for (const Compression known : {Compression::none, Compression::lz4, Compression::zstd}) {
    if (name(known) == name_in_file) return known;
  }
  throw std::runtime_error("a chunk is compressed with " + std::string(name_in_file) +
                           "; zstd and lz4 can be read");
}

Bytes compress(ByteView data, Compression compression, int level) {
  switch (compression) {
    case Compression::none:
      break;
    case Compression::lz4:
      return compress_lz4(data, level);
    case Compression::zstd:
      return compress_zstd(data, level);
  }
  return {data.begin(), data.end()};
}

Bytes decompress(ByteView data, Compression compression, std::uint64_t size) {
  if (compression == Compression::none) {
    if (data.size() != size) throw std::runtime_error("a chunk has another size than its header contains");
    return {data.begin(), data.end()};
  }
  if (size > kLargestChunk_bytes) {
    throw std::runtime_error("a chunk would be of " + std::to_string(size) + " bytes; at most " +
                             std::to_string(kLargestChunk_bytes) + " are read");
  }
  const bool possible =
      compression == Compression::zstd
          ? size <= kZstdLimit * data.size() && ZSTD_getFrameContentSize(data.data(), data.size()) == size
          : size <= kLz4Limit * data.size();
  if (!possible) throw std::runtime_error("a chunk has another size than its header contains");
  Bytes out(size);
  const std::size_t given = compression == Compression::zstd
                                ? ZSTD_decompress(out.data(), out.size(), data.data(), data.size())
                                : decompress_lz4(data, out);
  if (given != size) throw std::runtime_error("a compressed chunk is damaged");
  return out;
}

}  // namespace stilt::mcap
