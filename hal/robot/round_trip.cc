#include "hal/robot/round_trip.h"

#include <algorithm>
#include <optional>

namespace stilt::hal {
namespace {

constexpr std::int64_t kPause_ns = 10'000;

}  // namespace

std::array<ReplyFrame, kJoints> reply_frames(const RobotWiring& wiring) noexcept {
  std::array<ReplyFrame, kJoints> replies;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const JointWiring& wired = wiring.joints[joint];
    const std::optional<ReplyId> reply =
        visit_driver(wired.driver, [](const auto& driver) { return reply_id(driver); });
    if (reply) replies[joint] = {true, wired.bus, *reply};
  }
  return replies;
}

RoundTrip::RoundTrip(const RobotWiring& wiring, std::span<TapBus> taps) noexcept
    : taps_(taps), replies_(reply_frames(wiring)) {}

bool RoundTrip::all_replied() noexcept {
  bool all = true;
  for (std::size_t bus = 0; bus < taps_.size(); ++bus) {
    const std::span<const CanFrame> frames = taps_[bus].listen();
    for (const ReplyFrame& reply : replies_) {
      if (!reply.exists || reply.bus != bus) continue;
      all = all && std::ranges::any_of(frames, [&reply](const auto& frame) { return reply.is(frame); });
    }
  }
  return all;
}

std::int64_t RoundTrip::measure(Clock& clock, std::int64_t sent_ns, std::int64_t give_up_ns) noexcept {
  if (std::ranges::none_of(replies_, &ReplyFrame::exists)) return -1;
  while (true) {
    const bool done = all_replied();
    const std::int64_t now_ns = clock.now_ns();
    if (done) return newest_ns_ = now_ns - sent_ns;
    if (now_ns + kPause_ns >= give_up_ns) return -1;
    static_cast<void>(clock.sleep_until(now_ns + kPause_ns));
  }
}

}  // namespace stilt::hal
