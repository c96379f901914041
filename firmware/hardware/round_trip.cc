#include "firmware/hardware/round_trip.h"

#include <algorithm>

namespace stilt::hardware {
namespace {

constexpr std::int64_t kPause_ns = 10'000;

}  // namespace

RoundTrip::RoundTrip(const hal::RobotWiring& wiring, std::span<TapBus> taps) noexcept : taps_(taps) {
  for (const hal::JointWiring& joint : wiring.joints) {
    if (const auto* mit = std::get_if<hal::protocol::MitDriver>(&joint.driver)) {
      replies_[count_++] = {joint.bus, mit->reply_id, false};
    } else if (const auto* moteus = std::get_if<hal::protocol::MoteusDriver>(&joint.driver)) {
      const std::uint32_t id = static_cast<std::uint32_t>(moteus->id) << 8 | moteus->source;
      replies_[count_++] = {joint.bus, id, id > hal::kMaximumStandardId};
    }
  }
}

bool RoundTrip::all_replied() noexcept {
  bool all = true;
  for (std::size_t bus = 0; bus < taps_.size(); ++bus) {
    const std::span<const hal::CanFrame> frames = taps_[bus].listen();
    for (const Reply& reply : std::span(replies_).first(count_)) {
      if (reply.bus != bus) continue;
      all = all && std::ranges::any_of(frames, [&reply](const hal::CanFrame& frame) {
              return frame.id == reply.id && frame.extended == reply.extended && !frame.error;
            });
    }
  }
  return all;
}

std::int64_t RoundTrip::measure(hal::Clock& clock, std::int64_t sent_ns, std::int64_t give_up_ns) noexcept {
  if (count_ == 0) return -1;
  while (true) {
    const bool done = all_replied();
    const std::int64_t now_ns = clock.now_ns();
    if (done) return now_ns - sent_ns;
    if (now_ns + kPause_ns >= give_up_ns) return -1;
    static_cast<void>(clock.sleep_until(now_ns + kPause_ns));
  }
}

}  // namespace stilt::hardware
