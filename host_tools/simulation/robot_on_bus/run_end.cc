#include "host_tools/simulation/robot_on_bus/run_end.h"

#include <poll.h>

#include <algorithm>
#include <ctime>

namespace stilt::robot_on_bus {

const char* reason_to_end(const RobotOnBus& robot, const RunOptions& options) {
  if (options.stop != nullptr && options.stop->load()) return "interrupted";
  const bool over = options.duration_s && robot.walk_time_s().value_or(-1.0) >= *options.duration_s - 1e-9;
  return over ? "duration" : nullptr;
}

bool all_connected(const std::vector<RobotBus>& buses) {
  return std::ranges::all_of(buses, &RobotBus::connected);
}

bool any_connected(const std::vector<RobotBus>& buses) {
  return std::ranges::any_of(buses, &RobotBus::connected);
}

void wait_for_frames(const RobotOnBus& robot, const std::vector<RobotBus>& buses, std::int64_t timeout_ns) {
  if (timeout_ns <= 0) return;
  std::vector<pollfd> descriptors;
  descriptors.reserve(buses.size());
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const int descriptor = robot.disconnected(i) ? -1 : buses[i].descriptor();  // poll() skips negative ones
    descriptors.push_back({descriptor, POLLIN, 0});
  }
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const timespec timeout{timeout_ns / kSecond_ns, timeout_ns % kSecond_ns};
  static_cast<void>(::ppoll(descriptors.data(), descriptors.size(), &timeout, nullptr));
}

std::vector<hal::FrameBus*> frame_buses(std::vector<RobotBus>& buses) {
  std::vector<hal::FrameBus*> frames;
  for (RobotBus& bus : buses) frames.push_back(&bus.frames());
  return frames;
}

void ProgressTicks::update(const RobotOnBus& robot, const RunOptions& options) {
  options.watch(robot);
  if (robot.time_s() < next_s_) return;
  next_s_ = robot.time_s() + 1.0;
  options.progress(robot);
}

}  // namespace stilt::robot_on_bus
