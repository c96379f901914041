#pragma once

#include <cstdint>
#include <optional>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"

/// Frames of CANopen: network management, SYNC, heartbeat, and reads and writes of single objects of up to
/// four bytes (expedited SDO). Pure functions, real-time safe. Source: CiA 301, "CANopen application layer
/// and communication profile", 4.2.0: 7.2.4 (SDO), 7.2.5 (SYNC), 7.2.8 (NMT, heartbeat, boot-up), 7.3.3
/// (predefined connection set).
namespace stilt::hal::canopen {

inline constexpr std::uint8_t kMaximumNode = 127;
inline constexpr std::uint32_t kSyncId = 0x080;
inline constexpr std::uint32_t kNmtId = 0x000;

/// Identifiers of a node.
[[nodiscard]] constexpr std::uint32_t tpdo1_id(std::uint8_t node) noexcept { return 0x180u + node; }
[[nodiscard]] constexpr std::uint32_t sdo_request_id(std::uint8_t node) noexcept { return 0x600u + node; }
[[nodiscard]] constexpr std::uint32_t sdo_answer_id(std::uint8_t node) noexcept { return 0x580u + node; }
[[nodiscard]] constexpr std::uint32_t heartbeat_id(std::uint8_t node) noexcept { return 0x700u + node; }

/// Commands of the network management (CiA 301).
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

/// States of a node, as its heartbeat reports them (CiA 301).
enum class NmtState : std::uint8_t { boot_up = 0, stopped = 4, operational = 5, pre_operational = 127 };

/// An entry of a node's object dictionary.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  friend bool operator==(const Object&, const Object&) = default;
};

/// @param node  1 to 127; 0: every node
[[nodiscard]] CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept;
/// Without a counter.
[[nodiscard]] CanFrame sync_frame() noexcept;
[[nodiscard]] CanFrame heartbeat_frame(std::uint8_t node, NmtState state) noexcept;
[[nodiscard]] CanFrame sdo_read_frame(std::uint8_t node, const Object& object) noexcept;
/// @param bytes  1, 2 or 4: size of the object
[[nodiscard]] CanFrame sdo_write_frame(std::uint8_t node, const Object& object, std::uint32_t value,
                                       std::uint8_t bytes) noexcept;

/// What a node answers to a read or a write.
struct SdoAnswer {
  enum class Kind : std::uint8_t { value, written, aborted };
  Kind kind = Kind::written;
  Object object;
  std::uint32_t value = 0;  ///< of the object, unsigned; aborted: the abort code
};

/// not_addressed: no answer of this node. wrong_length: not 8 bytes. malformed: none of the three kinds, such
/// as an object of more than four bytes.
[[nodiscard]] DecodeStatus decode_answer(std::uint8_t node, const CanFrame& frame,
                                         SdoAnswer& answer) noexcept;

/// The state a node reports; boot_up: it has just started. Nothing: another frame.
[[nodiscard]] std::optional<NmtState> decode_heartbeat(std::uint8_t node, const CanFrame& frame) noexcept;

/// What a node receives; the emulated node's side.
struct SdoRequest {
  bool write = false;
  Object object;
  std::uint32_t value = 0;
  std::uint8_t bytes = 0;  ///< of the value; 0: not given
};
[[nodiscard]] DecodeStatus decode_request(std::uint8_t node, const CanFrame& frame,
                                          SdoRequest& request) noexcept;
[[nodiscard]] CanFrame answer_frame(std::uint8_t node, const SdoAnswer& answer, std::uint8_t bytes) noexcept;

}  // namespace stilt::hal::canopen
