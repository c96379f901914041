#include "hal/can/fdcanusb/line_codec.h"

#include <algorithm>
#include <optional>

namespace stilt::hal::fdcanusb {
namespace {

constexpr std::string_view kHex = "0123456789ABCDEF";
constexpr unsigned kNoEvent = 7;

/// Appends to a text that is long enough for every command.
class Writer {
 public:
  explicit Writer(CommandText& text) noexcept : text_(text) {}

  void put(char letter) noexcept { text_[size_++] = letter; }
  void put(std::string_view letters) noexcept {
    for (const char letter : letters) put(letter);
  }
  void put_byte(std::uint8_t byte) noexcept {
    put(kHex[byte >> 4]);
    put(kHex[byte & 0xf]);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  CommandText& text_;
  std::size_t size_ = 0;
};

void put_id(Writer& writer, std::uint32_t id) noexcept {
  if (id > kMaximumStandardId) {
    writer.put_byte(static_cast<std::uint8_t>(id >> 24));
    writer.put_byte(static_cast<std::uint8_t>(id >> 16));
  }
  writer.put_byte(static_cast<std::uint8_t>(id >> 8));
  writer.put_byte(static_cast<std::uint8_t>(id));
}

/// What stands before the next blank; the text loses both. Two blanks in a row enclose an empty word.
std::string_view next_word(std::string_view& text) noexcept {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

std::optional<unsigned> digit(char letter, unsigned base) noexcept {
  if (letter >= '0' && letter <= '9') return static_cast<unsigned>(letter - '0');
  if (base != 16) return std::nullopt;
  if (letter >= 'A' && letter <= 'F') return static_cast<unsigned>(letter - 'A') + 10;
  if (letter >= 'a' && letter <= 'f') return static_cast<unsigned>(letter - 'a') + 10;
  return std::nullopt;
}

std::optional<std::uint32_t> number(std::string_view word, unsigned base) noexcept {
  constexpr std::size_t kMostDigits = 8;
  if (word.empty() || word.size() > kMostDigits) return std::nullopt;
  std::uint32_t value = 0;
  for (const char letter : word) {
    const auto next = digit(letter, base);
    if (!next) return std::nullopt;
    value = value * base + *next;
  }
  return value;
}

bool read_data(std::string_view word, CanFrame& frame) noexcept {
  if (word.size() % 2 != 0 || word.size() > 2 * kMaximumFrameBytes) return false;
  for (std::size_t i = 0; i < word.size(); i += 2) {
    const auto byte = number(word.substr(i, 2), 16);
    if (!byte) return false;
    frame.data[i / 2] = static_cast<std::uint8_t>(*byte);
  }
  frame.length = static_cast<std::uint8_t>(word.size() / 2);
  return true;
}

/// Longer words are the time of receipt and the number of a filter, which nothing here needs.
void read_flag(std::string_view word, CanFrame& frame) noexcept {
  if (word == "E" || word == "e") frame.extended = word == "E";
  if (word == "B" || word == "b") frame.bit_rate_switch = word == "B";
  if (word == "F" || word == "f") frame.fd = word == "F";
  if (word == "R" || word == "r") frame.remote = word == "R";
}

Line read_frame(std::string_view text) noexcept {
  Line line;
  CanFrame& frame = line.frame;
  const auto id = number(next_word(text), 16);
  if (!id || !read_data(next_word(text), frame)) return line;
  frame.id = *id;
  frame.extended = frame.id > kMaximumStandardId;
  frame.fd = frame.length > kClassicFrameBytes;
  while (!text.empty()) read_flag(next_word(text), frame);
  if (well_formed(frame)) line.kind = LineKind::received;
  return line;
}

Line read_status(std::string_view text) noexcept {
  Line line;
  unsigned found = 0;
  while (!text.empty()) {
    std::string_view word = next_word(text);
    const std::size_t sign = word.find('=');
    if (sign == std::string_view::npos) return line;
    const std::string_view name = word.substr(0, sign);
    const auto value = number(word.substr(sign + 1), 10);
    if (!value) return line;
    found += name == "lec" || name == "err" || name == "warn" || name == "busoff" ? 1 : 0;
    if (name == "lec") line.status.last_error = *value;
    if (name == "dlec") line.status.last_data_error = *value;
    if (name == "err") line.status.passive = *value != 0;
    if (name == "warn") line.status.warning = *value != 0;
    if (name == "busoff") line.status.off = *value != 0;
  }
  constexpr unsigned kNeeded = 4;
  if (found == kNeeded) line.kind = LineKind::status;
  return line;
}

}  // namespace

bool ControllerStatus::failing() const noexcept {
  const auto error = [](unsigned code) { return code != 0 && code != kNoEvent; };
  return off || error(last_error) || error(last_data_error);
}

bool ControllerStatus::quiet() const noexcept { return last_error == kNoEvent; }

std::size_t write_command(const CanFrame& frame, CommandText& text) noexcept {
  if (!well_formed(frame) || frame.error || frame.length == 0) return 0;
  Writer writer(text);
  // `send` takes the kind of the identifier from its size.
  writer.put(frame.extended && frame.id <= kMaximumStandardId ? "can ext " : "can send ");
  put_id(writer, frame.id);
  writer.put(' ');
  for (const std::uint8_t byte : frame.payload()) writer.put_byte(byte);
  writer.put(' ');
  writer.put(frame.bit_rate_switch ? 'B' : 'b');
  writer.put(frame.fd ? 'F' : 'f');
  if (frame.remote) writer.put('R');
  writer.put('\n');
  return writer.size();
}

Line read_line(std::string_view text) noexcept {
  constexpr std::string_view kReceived = "rcv ";
  Line line;
  if (text.starts_with(kReceived)) return read_frame(text.substr(kReceived.size()));
  if (text.starts_with("lec=")) return read_status(text);
  if (text == "OK") line.kind = LineKind::ok;
  if (text.starts_with("ERR")) {
    line.kind = text.starts_with("ERR not in BusOn") ? LineKind::not_on : LineKind::refused;
  }
  return line;
}

}  // namespace stilt::hal::fdcanusb
