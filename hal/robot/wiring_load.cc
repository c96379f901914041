#include "hal/robot/wiring_load.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stilt::hal {
namespace {

bool same_frame(const ChannelRow& a, const ChannelRow& b) noexcept {
  return a.id == b.id && a.extended == b.extended;
}

void add_channels(std::vector<PeriodicFrame>& list, std::span<const ChannelRow> rows, double sensor_hz) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto is_first = [&](const ChannelRow& row) { return same_frame(row, rows[i]); };
    if (std::any_of(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(i), is_first)) continue;
    std::size_t bytes = 0;
    for (const ChannelRow& row : rows) {
      if (!same_frame(row, rows[i])) continue;
      bytes = std::max<std::size_t>(bytes, row.byte_offset + (row.bits + row.bit_offset + 7u) / 8u);
    }
    const std::uint8_t length = fd_length(bytes);
    list.push_back({.length = length,
                    .extended = rows[i].extended,
                    .fd = length > kClassicFrameBytes,
                    .rate_hz = sensor_hz});
  }
}

}  // namespace

std::vector<PeriodicFrame> periodic_frames(const RobotWiring& wiring, std::size_t bus, double tick_hz,
                                           double sensor_hz) {
  std::vector<PeriodicFrame> list;
  for (const JointWiring& joint : wiring.joints) {
    if (joint.bus != bus) continue;
    std::vector<PeriodicFrame> frames =
        visit_driver(joint.driver, [&](const auto& driver) { return periodic_frames(driver, tick_hz); });
    for (PeriodicFrame& frame : frames) {
      if (!joint.can_fd) break;
      frame.fd = true;
      frame.bit_rate_switch = joint.bit_rate_switch;
    }
    list.insert(list.end(), frames.begin(), frames.end());
  }
  if (wiring.channel_bus == bus) {
    add_channels(list, std::span(wiring.channels).first(wiring.channel_count), sensor_hz);
  }
  if (wiring.pitch_encoder && wiring.pitch_encoder_bus == bus) {
    const double sync_hz = std::min(sensor_hz, tick_hz);
    const std::vector<PeriodicFrame> frames = canopen::periodic_frames(*wiring.pitch_encoder, sync_hz);
    list.insert(list.end(), frames.begin(), frames.end());
  }
  return list;
}

NodeIdentifiers identifiers(const JointDriver& driver) {
  return visit_driver(driver, [](const auto& any) { return identifiers(any); });
}

NodeIdentifiers identifiers(const ChannelRow& channel) {
  const IdPattern frame{.value = channel.id, .standard = !channel.extended, .extended = channel.extended};
  return {{}, {}, {frame}, {}};
}

std::vector<FrameId> receive_ids(const RobotWiring& wiring, std::size_t bus) {
  std::vector<FrameId> all;
  for (const JointWiring& joint : wiring.joints) {
    if (joint.bus != bus) continue;
    const std::vector<FrameId> ids =
        visit_driver(joint.driver, [](const auto& driver) { return receive_ids(driver); });
    all.insert(all.end(), ids.begin(), ids.end());
  }
  if (wiring.channel_bus == bus) {
    for (const ChannelRow& row : std::span(wiring.channels).first(wiring.channel_count)) {
      all.push_back({row.id, row.extended});
    }
  }
  if (wiring.pitch_encoder && wiring.pitch_encoder_bus == bus) {
    const std::vector<FrameId> ids = canopen::receive_ids(*wiring.pitch_encoder);
    all.insert(all.end(), ids.begin(), ids.end());
  }
  return all;
}

bool uses_fd(const RobotWiring& wiring, std::size_t bus) noexcept {
  return std::any_of(wiring.joints.begin(), wiring.joints.end(), [bus](const JointWiring& joint) {
    return joint.bus == bus &&
           (joint.can_fd || visit_driver(joint.driver, [](const auto& driver) { return uses_fd(driver); }));
  });
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
             ": use a faster bit rate or CAN FD, put fewer drivers on this bus, or lower the rate of the "
             "torque loop";
  }
  return text;
}

}  // namespace stilt::hal
