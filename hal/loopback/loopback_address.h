#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

/// A bus without CAN hardware: the same frames, byte for byte, over a Unix SOCK_SEQPACKET socket with an
/// abstract name. The simulated robot listens, one controller connects. After connecting the robot greets
/// with eight bytes, then only frames follow. It returns each frame it takes, marked as echo, as a CAN
/// controller would.
namespace stilt::hal::loopback {

inline constexpr std::string_view kPrefix = "loopback:";
inline constexpr std::size_t kLongestName = 64;

/// 1 to 64 letters, digits, '.', '_' or '-'.
[[nodiscard]] bool valid_name(std::string_view name) noexcept;

/// Abstract address of a Unix socket.
struct Address {
  sockaddr_un address{};
  socklen_t length = 0;
};
/// Of a valid name.
[[nodiscard]] Address address_of(std::string_view name) noexcept;

/// First answer of the listener to a controller.
enum class Greeting : std::uint8_t {
  welcome = 0,
  busy = 1,  ///< another controller has the bus
};
using GreetingBytes = std::array<std::uint8_t, 8>;
[[nodiscard]] GreetingBytes greeting_bytes(Greeting greeting) noexcept;
/// Nothing when the bytes are no greeting, or one of another version.
[[nodiscard]] std::optional<Greeting> read_greeting(const GreetingBytes& bytes, std::size_t size) noexcept;

}  // namespace stilt::hal::loopback
