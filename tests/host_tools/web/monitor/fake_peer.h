#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// A page that keeps what it is sent.
class FakePeer final : public Peer {
 public:
  void send(SharedMessage message) override { messages.push_back(std::move(message)); }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
  void hold(bool is_held) override { held = is_held; }
  [[nodiscard]] const std::string& subprotocol() const override { return subprotocol_; }

  /// The text messages of a type, oldest first.
  [[nodiscard]] std::vector<nlohmann::json> of_type(const std::string& type) const {
    std::vector<nlohmann::json> found;
    for (const SharedMessage& message : messages) {
      if (message->binary) continue;
      auto json = nlohmann::json::parse(message->bytes);
      if (json.at("type") == type) found.push_back(std::move(json));
    }
    return found;
  }

  std::vector<SharedMessage> messages;
  bool held = false;

 private:
  std::string subprotocol_;
};

}  // namespace stilt::monitor
