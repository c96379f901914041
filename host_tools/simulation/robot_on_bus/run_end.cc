#include "host_tools/simulation/robot_on_bus/run_end.h"

#include <poll.h>

#include <algorithm>
#include <ctime>

namespace stilt::robot_on_bus {

const char* RunEnd::reason(const RobotOnBus& robot, bool has_controller) {
  if (options_.stop != nullptr && options_.stop->load()) return "interrupted";
  if (is_asked_to_end(robot, has_controller)) return "interrupted";
  const bool over = options_.duration_s && robot.walk_time_s().value_or(-1.0) >= *options_.duration_s - 1e-9;
  return over ? "duration" : nullptr;
}

bool RunEnd::is_asked_to_end(const RobotOnBus& robot, bool has_controller) {
  if (options_.stop_after_controller == nullptr || !options_.stop_after_controller->load()) return false;
  if (!asked_s_) asked_s_ = robot.time_s();
  return !has_controller || robot.time_s() - *asked_s_ >= options_.stop_wait_s;
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
