#include "firmware/telemetry/cdr.h"

#include <dds/ddsi/ddsi_cdrstream.h>

#include <array>
#include <cstring>

namespace stilt::telemetry::internal {
namespace {

constexpr std::size_t kHeader_bytes = 4;
constexpr std::array<std::byte, kHeader_bytes> kLittleEndian = {std::byte{0}, std::byte{1}, std::byte{0},
                                                                std::byte{0}};
constexpr std::uint32_t kPlainCdr = 1;

}  // namespace

Cdr encode(const dds_topic_descriptor_t& type, const void* message) {
  dds_ostreamLE_t stream;
  dds_ostreamLE_init(&stream, 0, kPlainCdr);
  Cdr cdr(kLittleEndian.begin(), kLittleEndian.end());
  if (dds_stream_writeLE(&stream, static_cast<const char*>(message), type.m_ops) != nullptr) {
    const auto* bytes = reinterpret_cast<const std::byte*>(stream.x.m_buffer);
    cdr.insert(cdr.end(), bytes, bytes + stream.x.m_index);
  }
  dds_ostreamLE_fini(&stream);
  return cdr;
}

bool decode(const dds_topic_descriptor_t& type, std::span<const std::byte> cdr, void* message) {
  // The last two bits of the header hold how many bytes at the end only fill up.
  // No message of ours is without fields.
  if (cdr.size() <= kHeader_bytes || cdr[0] != std::byte{0}) return false;
  const bool big_endian = cdr[1] == std::byte{0};
  if (!big_endian && cdr[1] != std::byte{1}) return false;
  std::vector<std::byte> fields(cdr.begin() + kHeader_bytes, cdr.end());
  const auto size = static_cast<std::uint32_t>(fields.size());
  std::uint32_t used = 0;
  if (dds_stream_normalize_data(reinterpret_cast<char*>(fields.data()), &used, size, big_endian, kPlainCdr,
                                type.m_ops) == nullptr) {
    return false;
  }
  dds_istream_t stream;
  dds_istream_init(&stream, size, fields.data(), kPlainCdr);
  std::memset(message, 0, type.m_size);
  static_cast<void>(dds_stream_read(&stream, static_cast<char*>(message), type.m_ops));
  dds_istream_fini(&stream);
  return true;
}

}  // namespace stilt::telemetry::internal
