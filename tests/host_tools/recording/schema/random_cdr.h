#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "host_tools/recording/schema/message_types.h"

namespace stilt::schema {

/// Writes messages of any type with random numbers, strings and lengths: little-endian CDR with its header.
class RandomCdr {
 public:
  RandomCdr(const MessageTypes& types, unsigned seed) : types_(types), random_(seed) {}

  std::vector<std::byte> write(const std::string& name) {
    bytes_ = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    put_message(name);
    return bytes_;
  }

 private:
  void put_message(const std::string& name) {
    for (const Field& field : types_.at(name)) {
      std::size_t count = field.count;
      if (field.shape == Shape::sequence) put_number<std::uint32_t>(count = random_() % 6);
      for (std::size_t i = 0; i < count; ++i) put_value(field.type);
    }
  }

  void put_value(const std::string& type) {
    if (type == "bool") return put_number<std::uint8_t>(random_() % 2);
    if (type == "int8" || type == "uint8") return put_number<std::uint8_t>(random_());
    if (type == "int16" || type == "uint16") return put_number<std::uint16_t>(random_());
    if (type == "int32" || type == "uint32") return put_number<std::uint32_t>(random_());
    if (type == "int64" || type == "uint64") return put_number<std::uint64_t>(random_());
    if (type == "float32") return put_number<float>(static_cast<float>(random_() % 1000) / 7.0f);
    if (type == "float64") return put_number<double>(static_cast<double>(random_()) / 7.0);
    if (type == "string") return put_string();
    put_message(type);
  }

  void put_string() {
    const std::size_t length = random_() % 9;
    put_number<std::uint32_t>(length + 1);
    for (std::size_t i = 0; i < length; ++i) bytes_.push_back(static_cast<std::byte>('a' + random_() % 26));
    bytes_.push_back(std::byte{0});
  }

  /// Numbers stand at multiples of their size, counted from behind the header.
  template <class T>
  void put_number(auto value) {
    const T number = static_cast<T>(value);
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(std::byte{0});
    const auto* raw = reinterpret_cast<const std::byte*>(&number);
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
  }

  const MessageTypes& types_;
  std::mt19937_64 random_;
  std::vector<std::byte> bytes_;
};

}  // namespace stilt::schema
