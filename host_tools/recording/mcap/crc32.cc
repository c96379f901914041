#include "host_tools/recording/mcap/crc32.h"

#include <array>

namespace stilt::mcap {
namespace {

using Table = std::array<std::uint32_t, 256>;

/// tables[k][b]: the checksum of byte b followed by k zero bytes.
constexpr std::array<Table, 8> make_tables() {
  std::array<Table, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? (sum >> 1) ^ 0xEDB88320u : sum >> 1;
    tables[0][byte] = sum;
  }
  for (std::size_t zeros = 1; zeros < tables.size(); ++zeros) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t sum = tables[zeros - 1][byte];
      tables[zeros][byte] = (sum >> 8) ^ tables[0][sum & 0xff];
    }
  }
  return tables;
}

constexpr std::array<Table, 8> kTables = make_tables();

}  // namespace

std::uint32_t crc32(ByteView data, std::uint32_t before) {
  std::uint32_t sum = ~before;
  while (data.size() >= 8) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::uint32_t mixed = i < 4 ? data[i] ^ ((sum >> (8 * i)) & 0xff) : data[i];
      next ^= kTables[7 - i][mixed];
    }
    sum = next;
    data = data.subspan(8);
  }
  for (const std::uint8_t byte : data) sum = (sum >> 8) ^ kTables[0][(sum ^ byte) & 0xff];
  return ~sum;
}

}  // namespace stilt::mcap
