#include "firmware/control_loop/plan_checksum.h"

#include <array>
#include <bit>

namespace stilt::control_loop {
namespace {

/// Four running sums side by side, each multiplied with an odd number after every word. A change of one word
/// never vanishes, and the processor works on all four at once.
class Checksum {
 public:
  void add(std::uint64_t word) noexcept { mix(lanes_[0], word); }
  void add(double number) noexcept { add(std::bit_cast<std::uint64_t>(number)); }

  void add(const double* numbers, int count) noexcept {
    for (int i = 0; i < count; ++i) {
      mix(lanes_[static_cast<std::size_t>(i) % kLanes], std::bit_cast<std::uint64_t>(numbers[i]));
    }
  }

  [[nodiscard]] std::uint64_t result() const noexcept {
    std::uint64_t sum = kStart;
    for (const std::uint64_t lane : lanes_) mix(sum, lane);
    sum ^= sum >> 32;
    return sum == 0 ? 1 : sum;
  }

 private:
  static constexpr std::size_t kLanes = 4;
  static constexpr std::uint64_t kStart = 0xcbf29ce484222325;  // as FNV-1a begins
  static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15;    // 2^64 / golden ratio

  static void mix(std::uint64_t& lane, std::uint64_t word) noexcept {
    lane = std::rotl(lane ^ word, 29) * kOdd;
  }

  std::array<std::uint64_t, kLanes> lanes_ = {kStart, kStart + 1, kStart + 2, kStart + 3};
};

}  // namespace

std::uint64_t plan_checksum(const control::Plan& plan) noexcept {
  Checksum sum;
  sum.add(static_cast<std::uint64_t>(plan.sequence));
  sum.add(static_cast<std::uint64_t>(plan.nodes));
  sum.add(plan.start_time_s);
  sum.add(static_cast<std::uint64_t>(plan.gait));
  sum.add(plan.phase_end_s);
  for (int k = 0; k < plan.nodes; ++k) {
    const control::PlanNode& node = plan.node[static_cast<std::size_t>(k)];
    sum.add(node.time_s);
    sum.add(node.state.data(), model::kStates);
    sum.add(node.input.data(), model::kInputs);
    sum.add(node.gain.data(), model::kInputs * model::kStates);
    sum.add(static_cast<std::uint64_t>((node.mode[0] ? 1 : 0) + (node.mode[1] ? 2 : 0)));
  }
  return sum.result();
}

}  // namespace stilt::control_loop
