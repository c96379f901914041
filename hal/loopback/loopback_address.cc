#include "hal/loopback/loopback_address.h"

#include <algorithm>

namespace stilt::hal::loopback {
namespace {

constexpr std::string_view kPath = "stilt-loopback/";
constexpr std::uint8_t kVersion = 1;
constexpr std::array<std::uint8_t, 6> kMagic{'s', 't', 'i', 'l', 't', 0};

bool allowed(char letter) noexcept {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '.' || letter == '_' || letter == '-';
}

}  // namespace

bool valid_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongestName && std::all_of(name.begin(), name.end(), allowed);
}

Address address_of(std::string_view name) noexcept {
  Address result;
  result.address.sun_family = AF_UNIX;
  char* path = result.address.sun_path + 1;  // a leading zero: abstract, no file to clean up
  path = std::copy(kPath.begin(), kPath.end(), path);
  path = std::copy(name.begin(), name.end(), path);
  result.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) +
                                         static_cast<std::size_t>(path - result.address.sun_path));
  return result;
}

GreetingBytes greeting_bytes(Greeting greeting) noexcept {
  GreetingBytes bytes{};
  std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
  bytes[6] = kVersion;
  bytes[7] = static_cast<std::uint8_t>(greeting);
  return bytes;
}

std::optional<Greeting> read_greeting(const GreetingBytes& bytes, std::size_t size) noexcept {
  for (const Greeting greeting : {Greeting::welcome, Greeting::busy}) {
    if (size == bytes.size() && bytes == greeting_bytes(greeting)) return greeting;
  }
  return std::nullopt;
}

}  // namespace stilt::hal::loopback
