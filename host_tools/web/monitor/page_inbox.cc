#include "host_tools/web/monitor/page_inbox.h"

namespace stilt::monitor {

std::string PageInbox::Box::pop() {
  std::string text = std::move(texts.front());
  texts.pop_front();
  bytes -= text.size();
  return text;
}

void PageInbox::open(Peer& peer) {
  const std::lock_guard lock(mutex_);
  boxes_[&peer] = {};
}

void PageInbox::close(Peer& peer) {
  const std::lock_guard lock(mutex_);
  boxes_.erase(&peer);
}

void PageInbox::trust(Peer& peer, bool trusted) {
  const std::lock_guard lock(mutex_);
  if (const auto box = boxes_.find(&peer); box != boxes_.end()) box->second.trusted = trusted;
}

void PageInbox::add(Peer& peer, std::string_view text) {
  const std::lock_guard lock(mutex_);
  const auto found = boxes_.find(&peer);
  if (found == boxes_.end()) return;
  Box& box = found->second;
  const Room room = box.trusted ? kOfTrusted : kOfOthers;
  if (box.texts.size() >= room.messages || box.bytes + text.size() > room.bytes) return;
  box.texts.emplace_back(text);
  box.bytes += text.size();
}

std::vector<std::pair<Peer*, std::string>> PageInbox::take() {
  std::vector<std::pair<Peer*, std::string>> taken;
  const std::lock_guard lock(mutex_);
  for (auto& [peer, box] : boxes_) {
    while (box.trusted && !box.texts.empty()) taken.emplace_back(peer, box.pop());
  }
  Room left = kPerStep;
  auto next = boxes_.upper_bound(last_);
  for (std::size_t without = 0; without < boxes_.size() && left.messages > 0; ++next) {
    if (next == boxes_.end()) next = boxes_.begin();
    auto& [peer, box] = *next;
    ++without;
    if (box.texts.empty()) continue;
    if (box.texts.front().size() > left.bytes) break;
    taken.emplace_back(peer, box.pop());
    last_ = peer;
    without = 0;
    --left.messages;
    left.bytes -= taken.back().second.size();
  }
  return taken;
}

}  // namespace stilt::monitor
