#pragma once

#include <deque>
#include <optional>

#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// Messages for a page that opens later, so that its plots are full at once. They are the newest message of
/// each lasting kind, the last events, and the tables of the last seconds.
class History {
 public:
  /// Seconds of tables, and number of events.
  static constexpr double kKept_s = 12.0;
  static constexpr std::size_t kEvents = 200;

  void configuration(SharedMessage message) { configuration_ = std::move(message); }
  void supervisor(SharedMessage message) { supervisor_ = std::move(message); }
  void timing(SharedMessage message) { timing_ = std::move(message); }
  void plan(SharedMessage message) { plan_ = std::move(message); }

  void event(SharedMessage message) {
    events_.push_back(std::move(message));
    if (events_.size() > kEvents) events_.pop_front();
  }

  /// Adds a table received at `now_s` of any steady clock.
  void table(double now_s, SharedMessage message) {
    tables_.push_back({now_s, std::move(message)});
    while (tables_.front().came_s < now_s - kKept_s) tables_.pop_front();
  }

  /// Removes what is of the previous run.
  void clear_run() {
    tables_.clear();
    events_.clear();
    plan_.reset();
    supervisor_.reset();
    timing_.reset();
  }

  void send_to(Peer& peer) const {
    const auto send = [&](const SharedMessage& message) {
      if (message) peer.send(message);
    };
    send(configuration_);
    for (const auto& table : tables_) send(table.message);
    send(plan_);
    send(supervisor_);
    for (const auto& event : events_) send(event);
    send(timing_);
  }

 private:
  struct Table {
    double came_s;
    SharedMessage message;
  };
  SharedMessage configuration_, supervisor_, timing_, plan_;
  std::deque<SharedMessage> events_;
  std::deque<Table> tables_;
};

}  // namespace stilt::monitor
