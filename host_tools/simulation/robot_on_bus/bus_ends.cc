#include "host_tools/simulation/robot_on_bus/bus_ends.h"

#include <algorithm>
#include <array>

namespace stilt::robot_on_bus {
namespace {

constexpr std::size_t kMostWaiting = 1000;  // frames kept for a controller that does not read

}  // namespace

BusEnds::BusEnds(RobotOnBus& robot, std::span<hal::FrameBus* const> buses, FrameLog& log)
    : robot_(robot), buses_(buses.begin(), buses.end()), log_(log), waiting_(buses.size()) {}

std::vector<hal::CanFrame> BusEnds::receive(std::size_t bus) {
  std::vector<hal::CanFrame> all;
  std::array<hal::CanFrame, hal::kMaximumBatch> batch;
  hal::ReceiveResult result;
  do {
    result = buses_[bus]->receive(batch);
    all.insert(all.end(), batch.begin(), batch.begin() + static_cast<std::ptrdiff_t>(result.received));
  } while (result.status == hal::BusStatus::more);
  return all;
}

void BusEnds::deliver(std::int64_t now_ns, std::size_t bus, const hal::CanFrame& frame) {
  log_.write(robot_.ticks(), bus, FrameLog::Sender::controller, frame);
  robot_.receive(now_ns, bus, frame);
}

std::vector<hal::CanFrame> BusEnds::take_outgoing(std::int64_t now_ns, std::size_t bus) {
  std::vector<hal::CanFrame> frames = robot_.take_outgoing(now_ns, bus);
  for (const hal::CanFrame& frame : frames) {
    log_.write(robot_.ticks(), bus, FrameLog::Sender::robot, frame);
  }
  return frames;
}

void BusEnds::send_outgoing(std::int64_t now_ns) {
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
    const std::vector<hal::CanFrame> frames = take_outgoing(now_ns, bus);
    waiting_[bus].insert(waiting_[bus].end(), frames.begin(), frames.end());
    flush(bus);
  }
}

void BusEnds::discard_outgoing(std::int64_t now_ns) {
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) static_cast<void>(take_outgoing(now_ns, bus));
}

void BusEnds::send(std::size_t bus, const hal::CanFrame& frame) {
  waiting_[bus].push_back(frame);
  flush(bus);
}

void BusEnds::flush(std::size_t bus) {
  std::vector<hal::CanFrame>& waiting = waiting_[bus];
  std::size_t done = 0;
  while (done < waiting.size()) {
    const std::size_t batch = std::min(waiting.size() - done, hal::kMaximumBatch);
    const hal::SendResult result = buses_[bus]->send(std::span(waiting).subspan(done, batch));
    const bool full = result.status == hal::BusStatus::queue_full;
    done += full ? result.sent : batch;
    if (full) break;
  }
  waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(done));
  if (waiting.size() > kMostWaiting) waiting.clear();
}

void BusEnds::forget() {
  for (std::vector<hal::CanFrame>& waiting : waiting_) waiting.clear();
}

}  // namespace stilt::robot_on_bus
