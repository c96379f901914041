#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "host_tools/recording/mcap/records.h"

namespace stilt::mcap {

/// Appends little-endian numbers and strings to bytes.
class ByteWriter {
 public:
  template <std::unsigned_integral T>
  void put(T value) {
    std::array<std::uint8_t, sizeof(T)> bytes;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    put_raw(ByteView(bytes));
  }
  void put_time(std::int64_t time_ns) { put(static_cast<std::uint64_t>(time_ns)); }
  void put_raw(ByteView data) {
    const std::size_t size = bytes_.size();
    bytes_.resize(size + data.size());
    std::copy(data.begin(), data.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
  }
  void put_raw(std::string_view text) {
    put_raw(ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  void put_string(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_raw(text);
  }
  void put_map(const StringMap& map) {
    ByteWriter entries;
    for (const auto& [key, value] : map) {
      entries.put_string(key);
      entries.put_string(value);
    }
    put(static_cast<std::uint32_t>(entries.bytes().size()));
    put_raw(entries.bytes());
  }
  /// Appends a map of numbers to numbers, after its length in bytes.
  template <std::unsigned_integral Key, std::unsigned_integral Value>
  void put_map(const std::map<Key, Value>& map) {
    put(static_cast<std::uint32_t>(map.size() * (sizeof(Key) + sizeof(Value))));
    for (const auto& [key, value] : map) {
      put(key);
      put(value);
    }
  }

  [[nodiscard]] const Bytes& bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  Bytes bytes_;
};

/// Reads little-endian numbers and strings from bytes. Throws std::runtime_error when they end too early.
class ByteReader {
 public:
  explicit ByteReader(ByteView data) : data_(data) {}

  template <std::unsigned_integral T>
  [[nodiscard]] T take() {
    const ByteView bytes = take_raw(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    return static_cast<T>(value);
  }
  [[nodiscard]] std::int64_t take_time() { return static_cast<std::int64_t>(take<std::uint64_t>()); }
  [[nodiscard]] ByteView take_raw(std::uint64_t count) {
    if (count > left()) throw std::runtime_error("a record ends too early");
    const ByteView taken = data_.subspan(at_, count);
    at_ += count;
    return taken;
  }
  [[nodiscard]] std::string take_string() { return text(take_raw(take<std::uint32_t>())); }
  [[nodiscard]] StringMap take_map() {
    ByteReader entries(take_raw(take<std::uint32_t>()));
    StringMap map;
    while (entries.left() > 0) {
      std::string key = entries.take_string();
      map[std::move(key)] = entries.take_string();
    }
    return map;
  }

  [[nodiscard]] std::uint64_t left() const { return data_.size() - at_; }
  [[nodiscard]] std::uint64_t position() const { return at_; }

  [[nodiscard]] static std::string text(ByteView bytes) { return {bytes.begin(), bytes.end()}; }

 private:
  ByteView data_;
  std::uint64_t at_ = 0;
};

}  // namespace stilt::mcap
