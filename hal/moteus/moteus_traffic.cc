#include "hal/moteus/moteus_driver.h"

namespace stilt::hal::moteus {
namespace {

constexpr std::uint32_t kReplyWanted = 0x8000;
/// Destination, and the prefix above source and destination, which is 0.
constexpr std::uint32_t kAddressed = 0x1fff00ff;

std::uint32_t command_id(const MoteusDriver& driver) {
  return kReplyWanted | static_cast<std::uint32_t>(driver.source) << 8 | driver.id;
}

}  // namespace

NodeIdentifiers identifiers(const MoteusDriver& driver) {
  const FrameId reply = *reply_id(driver);
  return {{{.value = command_id(driver), .standard = false, .extended = true}},
          {{.value = driver.id, .mask = kAddressed, .standard = true, .extended = true}},
          {{.value = reply.id, .standard = !reply.extended, .extended = reply.extended}},
          {}};
}

std::vector<FrameId> receive_ids(const MoteusDriver& driver) {
  return {*reply_id(driver), {command_id(driver), true}};
}

/// Command of 32 bytes with an extended identifier; the reply's is standard for drivers up to 7. The one in a
/// hundred that asks for the motor's temperature is not counted: it adds 0.1 % of a bus.
std::vector<PeriodicFrame> periodic_frames(const MoteusDriver& driver, double tick_hz) {
  const std::uint8_t reply = driver.extra_encoder >= 0 ? 48 : 24;
  return {{.length = 32,
           .extended = true,
           .fd = true,
           .bit_rate_switch = driver.bit_rate_switch,
           .rate_hz = tick_hz},
          {.length = reply,
           .extended = reply_id(driver)->extended,
           .fd = true,
           .bit_rate_switch = driver.bit_rate_switch,
           .rate_hz = tick_hz}};
}

}  // namespace stilt::hal::moteus
