#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fake_peer.h"
#include "host_tools/web/monitor/live_view.h"

namespace stilt::monitor {

/// A source that only keeps what it was given.
class SilentSource final : public SampleSource {
 public:
  void poll(SampleSink& sink) override {
    if (answers) {
      for (const Command& command : commands) {
        if (command.kind != CommandKind::heartbeat)
          sink.reply({command.commander, command.sequence, refusal.empty(), refusal});
      }
    }
    answers = false;
    if (news) news(sink);
    news = nullptr;
  }
  void command(const Command& command) override { commands.push_back(command); }
  void forget(std::uint64_t commander) override { forgotten.push_back(commander); }
  void choose(const std::string& run_id) override { chosen = run_id; }
  [[nodiscard]] std::string describe() const override { return "nothing"; }
  [[nodiscard]] bool live() const override { return true; }
  [[nodiscard]] bool has_token() const override { return true; }
  [[nodiscard]] std::string refused() const override { return unreadable; }

  [[nodiscard]] int heartbeats() const {
    return static_cast<int>(std::count_if(commands.begin(), commands.end(), [](const Command& command) {
      return command.kind == CommandKind::heartbeat;
    }));
  }

  std::vector<Command> commands;
  std::vector<std::uint64_t> forgotten;
  std::string chosen;
  std::string unreadable;  ///< what refused() gives
  bool answers = false;
  std::string refusal;                    ///< of all commands; empty: accepted
  std::function<void(SampleSink&)> news;  ///< given once
};

inline constexpr const char* kKey = "0123456789abcdef";

/// A page that was opened by the monitor's link.
inline void open_with_key(LiveView& view, const std::shared_ptr<FakePeer>& page) {
  view.opened(page);
  view.received(*page, false, std::string(R"({"key": ")") + kKey + "\"}");
}

inline constexpr const char* kWalk = R"({"command": "walk", "sequence": 7, "value": 0.5})";

}  // namespace stilt::monitor
