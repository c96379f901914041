#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_driver.h"

namespace stilt::hal::mit {
namespace {

const char* name(ReplyLayout layout) {
  switch (layout) {
    case ReplyLayout::mini_cheetah:
      return "mini-cheetah";
    case ReplyLayout::ak:
      return "AK";
    case ReplyLayout::damiao:
      return "Damiao";
  }
  return "";
}

}  // namespace

NodeIdentifiers identifiers(const MitDriver& driver) {
  const IdPattern command{.value = driver.command_id};
  NodeIdentifiers node{{command}, {command}, {{.value = driver.reply_id}}, name(driver.layout)};
  if (driver.layout == ReplyLayout::damiao) node.accepts.push_back({.value = kDamiaoRegisterId});
  return node;
}

std::vector<FrameId> receive_ids(const MitDriver& driver) {
  std::vector<FrameId> ids{{driver.command_id, false}, {driver.reply_id, false}};
  if (driver.layout == ReplyLayout::damiao) {
    ids.push_back({kDamiaoRegisterId, false});
    if (driver.reply_id != kDamiaoFactoryReplyId) ids.push_back({kDamiaoFactoryReplyId, false});
  }
  if (driver.layout == ReplyLayout::ak) {
    ids.push_back({ak_servo_status_id(driver), true});
    if (driver.reply_id != kAkZeroReplyId) ids.push_back({kAkZeroReplyId, false});
  }
  return ids;
}

std::vector<PeriodicFrame> periodic_frames(const MitDriver& driver, double tick_hz) {
  const std::uint8_t reply = driver.layout == ReplyLayout::mini_cheetah ? 7 : 8;  // with supply voltage
  return {{.length = 8, .rate_hz = tick_hz}, {.length = reply, .rate_hz = tick_hz}};
}

}  // namespace stilt::hal::mit
