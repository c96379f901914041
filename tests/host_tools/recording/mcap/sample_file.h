#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "host_tools/recording/mcap/writer.h"
#include "tests/own_folder.h"

namespace stilt::mcap {

/// A file of this test's own, gone with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name) : path_(folder_.file(name + ".mcap")) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] Bytes bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void set_bytes(ByteView data) const {
    std::ofstream file(path_, std::ios::binary);
    file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
  }

 private:
  tests::OwnFolder folder_;
  std::string path_;
};

/// Breaks the first chunk of a record that zstd has compressed. False: there is none.
inline bool damage_first_chunk(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  const std::size_t frame = bytes.find("\x28\xb5\x2f\xfd");
  if (frame == std::string::npos) return false;
  bytes[frame] = 'x';
  std::ofstream(path, std::ios::binary) << bytes;
  return true;
}

inline constexpr int kSampleMessages = 90;
inline constexpr int kSampleChunks = 9;

inline Bytes sample_data(int number) {
  Bytes data(static_cast<std::size_t>(number % 7) * 10);
  for (std::size_t i = 0; i < data.size(); ++i)
    data[i] = static_cast<std::uint8_t>(number + static_cast<int>(i));
  return data;
}

/// Two channels in turns, a chunk every ten messages, two attachments and metadata in between; not closed.
inline void write_sample(Writer& writer) {
  const std::uint16_t number = writer.add_schema("pkg/msg/Number", "ros2msg", "float64 value\n");
  const std::uint16_t first = writer.add_channel(number, "/first", "cdr", {{"frame", "world"}, {"a", "b"}});
  const std::uint16_t second = writer.add_channel(0, "/second", "json");
  writer.attach({5, 6, "configuration.toml", "application/toml", "a = 1\n"});
  for (int i = 0; i < kSampleMessages; ++i) {
    const Bytes data = sample_data(i);
    writer.write(
        {i % 2 == 0 ? first : second, static_cast<std::uint32_t>(i), 1'000'000 + i * 100, 900'000 + i, data});
    if (i % 10 == 9) writer.flush();
    if (i == 39) writer.write_metadata({"run", {{"number", "17"}}});
  }
  writer.attach({7, 8, "robot.urdf", "application/xml", std::string(1000, 'x')});
}

}  // namespace stilt::mcap
