#pragma once

#include <cstdint>

#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/mit/mit_mode.h"

/// Registers of Damiao drivers: read and written with classic frames of identifier 0x7ff, answered under the
/// identifier of the driver's replies. Only for bring-up with the motor off: a reply with position near one
/// end of its range can look like a register answer. Facts: github.com/jia-xie/python-damiao-driver,
/// docs/concept/communication-protocol.md and docs/concept/registers.md. Real-time safe, without state.
namespace stilt::hal::mit {

inline constexpr std::uint32_t kDamiaoRegisterId = 0x7ff;
inline constexpr std::uint16_t kDamiaoFactoryReplyId = 0;  ///< MST_ID of a new motor
inline constexpr double kDamiaoTimeoutUnit_s = 50e-6;      ///< one unit of the register TIMEOUT

/// Registers that bring-up reads and writes, by their numbers.
enum class DamiaoRegister : std::uint8_t {
  reply_id = 7,           ///< MST_ID, integer
  command_id = 8,         ///< ESC_ID, integer
  timeout = 9,            ///< TIMEOUT, integer in units of 50 us; 0: none
  control_mode = 10,      ///< CTRL_MODE, integer; 1 is MIT mode
  software_version = 14,  ///< sw_ver, integer
  position_range = 21,    ///< PMAX, float, rad: range is +-PMAX
  velocity_range = 22,    ///< VMAX, float, rad/s
  torque_range = 23,      ///< TMAX, float, Nm
};

/// A read, write or answer of one register.
struct DamiaoRegisterMessage {
  bool write = false;       ///< 0x55 instead of 0x33
  std::uint8_t number = 0;  ///< register
  std::uint32_t bits = 0;   ///< value as its four bytes: an integer, or the bits of a float
};

/// Request to the driver. invalid: identifiers beyond 11 bits.
[[nodiscard]] EncodeStatus encode_register_request(const MitDriver& driver,
                                                   const DamiaoRegisterMessage& message,
                                                   CanFrame& frame) noexcept;
/// Answer of the driver. not_addressed: not a register answer of this driver.
[[nodiscard]] DecodeStatus decode_register_answer(const MitDriver& driver, const CanFrame& frame,
                                                  DamiaoRegisterMessage& message) noexcept;
/// The driver's side.
[[nodiscard]] DecodeStatus decode_register_request(const MitDriver& driver, const CanFrame& frame,
                                                   DamiaoRegisterMessage& message) noexcept;
[[nodiscard]] EncodeStatus encode_register_answer(const MitDriver& driver,
                                                  const DamiaoRegisterMessage& message,
                                                  CanFrame& frame) noexcept;

}  // namespace stilt::hal::mit
