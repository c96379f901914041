#include "host_tools/recording/mcap/crc32.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string_view>

namespace stilt::mcap {
namespace {

ByteView bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(Crc32, PublishedCheckValues) {
  EXPECT_EQ(crc32({}), 0u);
  EXPECT_EQ(crc32(bytes("123456789")), 0xCBF43926u);
  EXPECT_EQ(crc32(bytes("The quick brown fox jumps over the lazy dog")), 0x414FA339u);
}

TEST(Crc32, SumOfPiecesIsTheSumOfTheWhole) {
  Bytes data(1000);
  std::iota(data.begin(), data.end(), std::uint8_t{3});
  const std::uint32_t whole = crc32(data);
  for (const std::size_t cut : {0u, 1u, 7u, 8u, 9u, 500u, 1000u}) {
    EXPECT_EQ(crc32(ByteView(data).subspan(cut), crc32(ByteView(data).first(cut))), whole) << cut;
  }
}

}  // namespace
}  // namespace stilt::mcap
