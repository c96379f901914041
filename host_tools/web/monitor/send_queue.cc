#include "host_tools/web/monitor/send_queue.h"

#include <utility>

namespace stilt::monitor {

SendQueue::SendQueue(std::string subprotocol, std::function<void()> wake)
    : subprotocol_(std::move(subprotocol)), wake_(std::move(wake)) {}

void SendQueue::send(SharedMessage message) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  if (message->droppable && waiting_bytes_ > kCongested_bytes) {
    ++dropped_;
    return;
  }
  waiting_bytes_ += message->bytes.size();
  waiting_.push_back(std::move(message));
  closed_ = hopeless_ = waiting_bytes_ > kHopeless_bytes;
  if (hopeless_) waiting_.clear();
  if (hopeless_ || waiting_.size() == 1) wake_();
}

std::uint64_t SendQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

SharedMessage SendQueue::front() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() ? nullptr : waiting_.front();
}

void SendQueue::pop() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return;  // given up while the message was sent
  waiting_bytes_ -= waiting_.front()->bytes.size();
  waiting_.pop_front();
}

bool SendQueue::hopeless() const {
  const std::lock_guard lock(mutex_);
  return hopeless_;
}

void SendQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  waiting_.clear();
}

}  // namespace stilt::monitor
