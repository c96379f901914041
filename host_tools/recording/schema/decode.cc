#include "host_tools/recording/schema/decode.h"

#include <charconv>
#include <cstring>
#include <stdexcept>

namespace stilt::schema {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kHeader_bytes = 4;

/// The shortest decimal number with the same float value: 0.1, not 0.10000000149.
double as_double(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  double number = static_cast<double>(value);
  std::from_chars(text, end, number);
  return number;
}

class Decoder {
 public:
  Decoder(const MessageTypes& types, std::span<const std::uint8_t> fields) : types_(types), bytes_(fields) {}

  Json message(const std::string& name) {
    Json json = Json::object();
    for (const Field& field : types_.at(name)) json[field.name] = value(field);
    return json;
  }

 private:
  Json value(const Field& field) {
    if (field.shape == Shape::single) return single(field.type);
    const std::size_t count = field.shape == Shape::array ? field.count : number<std::uint32_t>();
    if (count > bytes_.size()) throw std::runtime_error("a sequence is longer than its message");
    Json list = Json::array();
    for (std::size_t i = 0; i < count; ++i) list.push_back(single(field.type));
    return list;
  }

  Json single(const std::string& type) {
    if (type == "bool") return number<std::uint8_t>() != 0;
    if (type == "int8") return number<std::int8_t>();
    if (type == "uint8") return number<std::uint8_t>();
    if (type == "int16") return number<std::int16_t>();
    if (type == "uint16") return number<std::uint16_t>();
    if (type == "int32") return number<std::int32_t>();
    if (type == "uint32") return number<std::uint32_t>();
    if (type == "int64") return number<std::int64_t>();
    if (type == "uint64") return number<std::uint64_t>();
    if (type == "float32") return as_double(number<float>());
    if (type == "float64") return number<double>();
    if (type == "string") return text();
    return message(type);
  }

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size() - at_) throw std::runtime_error("a message ends too early");
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  /// Reads a number, aligned to a multiple of its size.
  template <class T>
  T number() {
    static_cast<void>(take((sizeof(T) - at_ % sizeof(T)) % sizeof(T)));
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  std::string text() {
    const auto size = number<std::uint32_t>();
    if (size == 0) return {};
    const auto bytes = take(size);
    return {bytes.begin(), bytes.end() - 1};
  }

  const MessageTypes& types_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace

nlohmann::ordered_json decode(const MessageTypes& types, const std::string& name,
                              std::span<const std::uint8_t> cdr) {
  if (cdr.size() < kHeader_bytes || cdr[0] != 0 || cdr[1] != 1) {
    throw std::runtime_error("a message of " + name + " is not plain little-endian CDR");
  }
  return Decoder(types, cdr.subspan(kHeader_bytes)).message(name);
}

}  // namespace stilt::schema
