#include "hal/robot/wiring_load.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stilt::hal {
namespace {

constexpr double kOdriveHeartbeat_hz = 10;
constexpr double kOdriveQuestions = 0.02;  // a tick: supply and temperatures (CanRobot)

void add(PeriodicFrames& list, const PeriodicFrame& frame) noexcept {
  if (list.count < list.frames.size()) list.frames[list.count++] = frame;
}

void add_mit(PeriodicFrames& list, const protocol::MitDriver& driver, double tick_hz) noexcept {
  add(list, {.length = 8, .rate_hz = tick_hz});
  const std::uint8_t reply =
      driver.layout == protocol::ReplyLayout::mini_cheetah ? 7 : 8;  // with supply voltage
  add(list, {.length = reply, .rate_hz = tick_hz});
}

/// Command of 32 bytes with an extended identifier; the reply's is standard for drivers up to 7.
void add_moteus(PeriodicFrames& list, const protocol::MoteusDriver& driver, double tick_hz) noexcept {
  const std::uint8_t reply = driver.extra_encoder >= 0 ? 32 : 20;
  const std::uint32_t reply_id = static_cast<std::uint32_t>(driver.id) << 8 | driver.source;
  add(list, {.length = 32,
             .extended = true,
             .fd = true,
             .bit_rate_switch = driver.bit_rate_switch,
             .rate_hz = tick_hz});
  add(list, {.length = reply,
             .extended = reply_id > kMaximumStandardId,
             .fd = true,
             .bit_rate_switch = driver.bit_rate_switch,
             .rate_hz = tick_hz});
}

void add_odrive(PeriodicFrames& list, double tick_hz) noexcept {
  add(list, {.length = 4, .rate_hz = tick_hz});  // torque
  add(list, {.length = 8, .rate_hz = tick_hz});  // encoder estimates
  add(list, {.length = 8, .rate_hz = kOdriveHeartbeat_hz});
  const double questions_hz = kOdriveQuestions * tick_hz;
  add(list, {.length = 0, .rate_hz = questions_hz});  // remote frames, and the answers
  add(list, {.length = 8, .rate_hz = questions_hz});
}

bool same_frame(const protocol::ChannelRow& a, const protocol::ChannelRow& b) noexcept {
  return a.id == b.id && a.extended == b.extended;
}

void add_channels(PeriodicFrames& list, std::span<const protocol::ChannelRow> rows,
                  double sensor_hz) noexcept {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto is_first = [&](const protocol::ChannelRow& row) { return same_frame(row, rows[i]); };
    if (std::any_of(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(i), is_first)) continue;
    std::size_t bytes = 0;
    for (const protocol::ChannelRow& row : rows) {
      if (!same_frame(row, rows[i])) continue;
      bytes = std::max<std::size_t>(bytes, row.byte_offset + (row.bits + row.bit_offset + 7u) / 8u);
    }
    const std::uint8_t length = fd_length(bytes);
    add(list, {.length = length,
               .extended = rows[i].extended,
               .fd = length > kClassicFrameBytes,
               .rate_hz = sensor_hz});
  }
}

}  // namespace

PeriodicFrames periodic_frames(const RobotWiring& wiring, std::size_t bus, double tick_hz,
                               double sensor_hz) noexcept {
  PeriodicFrames list;
  for (const JointWiring& joint : wiring.joints) {
    if (joint.bus != bus) continue;
    if (const auto* mit = std::get_if<protocol::MitDriver>(&joint.driver)) {
      add_mit(list, *mit, tick_hz);
    } else if (const auto* moteus = std::get_if<protocol::MoteusDriver>(&joint.driver)) {
      add_moteus(list, *moteus, tick_hz);
    } else {
      add_odrive(list, tick_hz);
    }
  }
  if (wiring.channel_bus == bus) {
    add_channels(list, std::span(wiring.channels).first(wiring.channel_count), sensor_hz);
  }
  return list;
}

std::string load_sentence(const std::string& bus_name, const BusLoad& load) {
  const auto percent = [](double fraction) { return std::to_string(std::lround(100 * fraction)) + " %"; };
  std::string text = "bus " + bus_name + ": worst-case load " + percent(load.fraction);
  switch (load.verdict) {
    case BusLoadVerdict::fine:
      return text;
    case BusLoadVerdict::high:
      return text + ", above " + percent(kHighLoad) + ": errors on the bus will delay replies";
    case BusLoadVerdict::refused:
      return text + ", above " + percent(kRefusedLoad) +
             ": give each leg its own bus, lower the rate of the torque loop, or use CAN FD";
  }
  return text;
}

}  // namespace stilt::hal
