#include "firmware/configuration/channel_text.h"

#include <charconv>
#include <cstdint>
#include <set>
#include <sstream>
#include <vector>

#include "firmware/configuration/schema.h"

namespace stilt::configuration {
namespace {

using hal::ByteOrder;
using hal::ChannelRow;
using hal::RawType;

constexpr std::string_view kForm =
    "; right would be \"none\" or such as \"id 0x150 byte 0 bits 24 signed little scale 1e-6\"";

std::optional<std::uint32_t> whole_number(std::string_view text) {
  const bool hexadecimal = text.starts_with("0x");
  if (hexadecimal) text.remove_prefix(2);
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value, hexadecimal ? 16 : 10);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
}

std::optional<double> real_number(std::string_view text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
}

/// A word that stands alone. False: it is none of these.
bool take_flag(std::string_view word, ChannelRow& row) {
  if (word == "extended") {
    row.extended = true;
  } else if (word == "signed") {
    row.type = RawType::signed_integer;
  } else if (word == "unsigned") {
    row.type = RawType::unsigned_integer;
  } else if (word == "float") {
    row.type = RawType::float32;
  } else if (word == "little") {
    row.order = ByteOrder::little;
  } else if (word == "big") {
    row.order = ByteOrder::big;
  } else {
    return false;
  }
  return true;
}

/// A word with a number behind it. False: unknown word, or not its number.
bool take_number(std::string_view word, std::string_view number, ChannelRow& row) {
  if (word == "scale" || word == "offset") {
    const auto value = real_number(number);
    if (!value) return false;
    (word == "scale" ? row.scale : row.offset) = *value;
    return true;
  }
  const auto value = whole_number(number);
  if (!value) return false;
  if (word == "id") {
    row.id = *value;
  } else if (word == "invalid") {
    row.has_invalid = true;
    row.invalid_bits = *value;
  } else if (*value > 64) {
    return false;
  } else if (word == "byte") {
    row.byte_offset = static_cast<std::uint8_t>(*value);
  } else if (word == "bit") {
    row.bit_offset = static_cast<std::uint8_t>(*value);
  } else if (word == "bits") {
    row.bits = static_cast<std::uint8_t>(*value);
  } else {
    return false;
  }
  return true;
}

/// What a word sets.
std::string_view meaning(std::string_view word) {
  if (word == "signed" || word == "unsigned" || word == "float") return "the type";
  if (word == "little" || word == "big") return "the byte order";
  return word;
}

}  // namespace

std::expected<std::optional<ChannelRow>, std::string> parse_channel(std::string_view text,
                                                                    hal::BaseChannel channel) {
  if (text == "none") return std::nullopt;
  std::istringstream stream{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  ChannelRow row;
  row.channel = channel;
  std::set<std::string_view> given;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (const std::string_view what = meaning(words[i]); !given.insert(what).second)
      return std::unexpected(std::string(what) + " is given twice" + std::string(kForm));
    if (take_flag(words[i], row)) continue;
    const std::string_view number = i + 1 < words.size() ? std::string_view(words[i + 1]) : "";
    if (!take_number(words[i], number, row)) {
      std::string mistake = '"' + words[i];
      if (!number.empty()) mistake.append(" ").append(number);
      return std::unexpected(mistake.append("\" is not understood").append(kForm));
    }
    ++i;
  }
  if (!given.contains("id"))
    return std::unexpected("the identifier of the frame is missing" + std::string(kForm));
  if (!hal::valid(row)) {
    return std::unexpected(
        "no frame holds this field: identifiers end at 0x7ff (0x1fffffff extended), fields have 1 to 32 bits "
        "(a float 32) within 64 bytes, and a scale that is not 0" +
        std::string(kForm));
  }
  return row;
}

std::string transformed_channel(std::string_view text, double factor, double offset) {
  std::istringstream stream{std::string(text)};
  std::string result;
  double scale = 1, old_offset = 0;
  for (std::string word; stream >> word;) {
    if (word == "scale") {
      stream >> scale;
    } else if (word == "offset") {
      stream >> old_offset;
    } else {
      result += word + ' ';
    }
  }
  const double new_offset = factor * old_offset + offset;
  result += "scale " + number_text(factor * scale);
  return new_offset == 0 ? result : result + " offset " + number_text(new_offset);
}

}  // namespace stilt::configuration
