#include "host_tools/simulation/robot_on_bus/frame_line.h"

#include <algorithm>

namespace stilt::robot_on_bus {

void FrameLine::send(double time_s, std::int64_t now_ns, const FrameSource& source,
                     const hal::CanFrame& frame) {
  hal::CanFrame arriving = frame;
  std::int64_t due_ns = now_ns;
  int copies = 1;
  for (const simulation::TimedFault& fault : faults_) {
    if (!fault.active(time_s) || !fault.affects(source.bus, source.joint)) continue;
    if (fault.kind == simulation::FaultKind::drop) return;
    if (fault.kind == simulation::FaultKind::delay) due_ns += kFrameDelay_ns;
    if (fault.kind == simulation::FaultKind::duplicate) ++copies;
    if (fault.kind == simulation::FaultKind::corrupt) arriving = corrupted(arriving);
  }
  for (; copies > 0; --copies) pending_.push_back({source.bus, due_ns, arriving});
}

bool FrameLine::lost(double time_s, std::size_t bus, std::size_t joint) const {
  return std::ranges::any_of(faults_, [&](const simulation::TimedFault& fault) {
    return fault.kind == simulation::FaultKind::drop && fault.active(time_s) && fault.affects(bus, joint);
  });
}

std::vector<hal::CanFrame> FrameLine::arrived(std::int64_t now_ns, std::size_t bus) {
  std::vector<hal::CanFrame> frames;
  std::erase_if(pending_, [&](const Pending& pending) {
    if (pending.bus != bus || pending.due_ns > now_ns) return false;
    frames.push_back(pending.frame);
    return true;
  });
  return frames;
}

/// Inverts one bit of the payload, a different one each time.
hal::CanFrame FrameLine::corrupted(hal::CanFrame frame) {
  constexpr std::uint64_t kStride = 29;  // prime, so that every bit gets inverted
  if (frame.length == 0) return frame;
  const std::uint64_t bit = corruptions_++ * kStride % (8u * frame.length);
  frame.data[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  return frame;
}

}  // namespace stilt::robot_on_bus
