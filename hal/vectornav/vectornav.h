#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

/// The binary output messages of VectorNav's inertial measurement units (VN-100 and later) on a serial port:
///
///   0xFA, groups, 16 bits of fields a group, values, CRC-16 (CCITT, from the groups on, high byte first)
///
/// Fixed memory, real-time safe. Source: VectorNav, "VN-100 User Manual" UM001, document revision 2.22,
/// chapter 4.3 (format, lengths of the fields, examples) and 5.2 (common group).
namespace stilt::hal::vectornav {

/// Values of one message. Frame of the sensor: x forward, y to the right, z down. NaN: not in the message.
struct Packet {
  static constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  double yaw_deg = kAbsent;
  double pitch_deg = kAbsent;                                   ///< positive: nose up
  double roll_deg = kAbsent;                                    ///< positive: right side down
  std::array<double, 3> rate_rad_s{kAbsent, kAbsent, kAbsent};  ///< about x, y, z
};

/// How the unit is mounted on the torso.
struct Mounting {
  bool by_roll = false;  ///< its x is parallel to the torso's y; else its y is
  double direction = 1;  ///< by_roll: 1 with x to the left; else 1 with x forward; -1: turned around
  double offset_rad = 0;
};
/// Pitch of the torso and its rate.
struct Pitch {
  double angle_rad = 0;
  double rate_rad_s = 0;
};
/// Of the torso, positive leans forward. NaN where the packet has no value.
[[nodiscard]] Pitch pitch_of(const Packet& packet, const Mounting& mounting) noexcept;
/// The other way, for the emulated sensor; upright otherwise.
[[nodiscard]] Packet packet_of(const Pitch& pitch, const Mounting& mounting) noexcept;

/// Finds messages in a stream of bytes that may begin, break off and be wrong anywhere. After a wrong
/// checksum or an impossible header it goes on with the byte after the sync byte: nothing that follows is
/// lost.
class Stream {
 public:
  static constexpr std::size_t kLongestPacket = 96;  ///< longer ones are not looked for
  static constexpr std::size_t kCapacity = 512;

  /// Appends bytes. @return  how many; fewer than given only when next() was not called until false
  std::size_t push(std::span<const std::uint8_t> bytes) noexcept;
  /// The next whole message with yaw, pitch and roll. False: more bytes are needed.
  [[nodiscard]] bool next(Packet& packet) noexcept;

  /// Messages with a wrong checksum, or angles that are no numbers, since the start.
  [[nodiscard]] std::uint32_t malformed() const noexcept { return malformed_; }
  /// Bytes that belong to no whole message, since the start.
  [[nodiscard]] std::uint64_t skipped_bytes() const noexcept { return skipped_; }

 private:
  void drop(std::size_t count) noexcept;

  std::array<std::uint8_t, kCapacity> bytes_{};
  std::size_t count_ = 0;
  std::uint32_t malformed_ = 0;
  std::uint64_t skipped_ = 0;
};

/// A message with yaw, pitch, roll and rates, as register 75 = 1,2,01,0028 makes it (any port and divisor).
inline constexpr std::size_t kPacketBytes = 30;
[[nodiscard]] std::array<std::uint8_t, kPacketBytes> encode(const Packet& packet) noexcept;

}  // namespace stilt::hal::vectornav
