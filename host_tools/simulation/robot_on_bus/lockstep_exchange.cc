#include "host_tools/simulation/robot_on_bus/lockstep_exchange.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "hal/can/lockstep.h"

namespace stilt::robot_on_bus {
namespace {

constexpr std::int64_t kStart_ns = 1'000'000'000;  // drivers interpret a time of 0 as "never"

}  // namespace

LockstepExchange::LockstepExchange(RobotOnBus& robot, BusEnds& ends, double tick_s,
                                   std::function<std::uint64_t(std::size_t)> connections)
    : robot_(robot),
      ends_(ends),
      tick_ns_(std::llround(tick_s * 1e9)),
      connections_(std::move(connections)),
      turns_(ends.count()),
      controller_(ends.count()) {}

std::int64_t LockstepExchange::now_ns() const {
  return kStart_ns + static_cast<std::int64_t>(robot_.ticks()) * tick_ns_;
}

void LockstepExchange::take(std::size_t bus) {
  ends_.flush(bus);
  Turn& turn = turns_[bus];
  // A bus accepts the next controller after reading: what is read now comes from the one connected before.
  const std::uint64_t connection = connections_(bus);
  if (connection != turn.connection) {  // another controller's turn begins
    turn = {.frames = {}, .ended = {}, .connection = connection};
  }
  for (const hal::CanFrame& frame : ends_.receive(bus)) {
    std::uint64_t tick = 0;
    if (hal::decode_sync(hal::kControllerSyncId, frame, tick) == hal::DecodeStatus::ok) {
      turn.ended = tick;
    } else {
      turn.frames.push_back(frame);
    }
  }
}

bool LockstepExchange::all_ended() const {
  return std::ranges::all_of(turns_, [this](const Turn& turn) {
    return turn.ended.has_value() && turn.ended == turns_.front().ended;
  });
}

void LockstepExchange::check_tick() const {
  const std::uint64_t ended = *turns_.front().ended;
  if (ended == 0 || (tick_ && ended == *tick_ + 1)) return;
  throw std::runtime_error("lock-step: the controller ended tick " + std::to_string(ended) + " where tick " +
                           (tick_ ? std::to_string(*tick_ + 1) : "0") + " was expected; restart both sides");
}

bool LockstepExchange::poll() {
  for (std::size_t bus = 0; bus < turns_.size(); ++bus) take(bus);
  if (!all_ended()) return false;
  check_tick();
  tick_ = turns_.front().ended;
  for (std::size_t bus = 0; bus < turns_.size(); ++bus) {
    for (const hal::CanFrame& frame : turns_[bus].frames) ends_.deliver(now_ns(), bus, frame);
    controller_[bus] = turns_[bus].connection;
    turns_[bus] = {};
  }
  if (*tick_ > 0) robot_.tick(now_ns() + tick_ns_);
  ends_.send_outgoing(now_ns());
  for (std::size_t bus = 0; bus < turns_.size(); ++bus) {
    ends_.send(bus, hal::sync_frame(hal::kRobotSyncId, *tick_));
  }
  return true;
}

void LockstepExchange::advance_alone() {
  robot_.tick(now_ns() + tick_ns_);
  ends_.discard_outgoing(now_ns());
}

void LockstepExchange::forget_controller() {
  for (std::size_t bus = 0; bus < turns_.size(); ++bus) {
    if (turns_[bus].connection == controller_[bus]) turns_[bus] = {};
  }
  tick_.reset();
  ends_.forget();
}

}  // namespace stilt::robot_on_bus
