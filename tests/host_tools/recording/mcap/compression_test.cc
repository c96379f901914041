#include "host_tools/recording/mcap/compression.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace stilt::mcap {
namespace {

constexpr std::uint32_t kSeed = 7;

Bytes sample(std::size_t size) {
  std::mt19937 random(kSeed);
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i % 3 == 0 ? random() : i / 100);
  return data;
}

class EachCompression : public testing::TestWithParam<Compression> {
  const testing::ScopedTrace trace_{__FILE__, __LINE__, kSeed};  // of sample()
};

TEST_P(EachCompression, GivesBackWhatItTook) {
  for (const std::size_t size : {0u, 1u, 1000u, 300'000u, 5'000'000u}) {
    const Bytes data = sample(size);
    EXPECT_EQ(decompress(compress(data, GetParam(), 1), GetParam(), size), data) << size;
  }
}

TEST_P(EachCompression, RefusesAnotherSizeThanSaid) {
  const Bytes compressed = compress(sample(1000), GetParam(), 1);
  EXPECT_THROW(static_cast<void>(decompress(compressed, GetParam(), 999)), std::runtime_error);
  EXPECT_THROW(static_cast<void>(decompress(compressed, GetParam(), 1001)), std::runtime_error);
}

TEST_P(EachCompression, RefusesWhatWasCutOff) {
  Bytes compressed = compress(sample(1000), GetParam(), 1);
  compressed.pop_back();
  EXPECT_THROW(static_cast<void>(decompress(compressed, GetParam(), 1000)), std::runtime_error);
}

TEST_P(EachCompression, HasItsName) { EXPECT_EQ(compression_named(name(GetParam())), GetParam()); }

INSTANTIATE_TEST_SUITE_P(Compression, EachCompression,
                         testing::Values(Compression::none, Compression::lz4, Compression::zstd));

TEST(Compression, ASizeThatNoChunkHasIsRefusedBeforeItIsAllocated) {
  Bytes frame = {0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0};  // zstd, its size in 8 bytes
  for (const int bit : {60, 63, 29}) {
    for (std::size_t i = 0; i < 8; ++i) frame[5 + i] = static_cast<std::uint8_t>((1ULL << bit) >> (8 * i));
    try {
      static_cast<void>(decompress(frame, Compression::zstd, 1ULL << bit));
      ADD_FAILURE() << "accepted " << bit;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(bit == 29 ? "another size" : "are read"), std::string::npos)
          << error.what();
    }
  }
}

/// A chunk of zeros is the smallest possible for its size.
TEST(Compression, ZerosAreReadBack) {
  const Bytes zeros(10'000'000);
  EXPECT_EQ(decompress(compress(zeros, Compression::zstd, 1), Compression::zstd, zeros.size()), zeros);
}

TEST(Compression, AnUnknownOneIsNamedInTheRefusal) {
  try {
    static_cast<void>(compression_named("brotli"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("brotli"), std::string::npos);
  }
}

}  // namespace
}  // namespace stilt::mcap
