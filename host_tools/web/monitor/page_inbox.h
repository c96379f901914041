#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// Messages of pages that wait for a step. Anyone may connect, so a page that is not trusted has little room,
/// and all such pages share what a step takes. Any thread.
class PageInbox {
 public:
  /// What waits at most, of one page; a message beyond is left out.
  struct Room {
    std::size_t messages;
    std::size_t bytes;
  };
  static constexpr Room kOfTrusted{200, 1U << 18U};
  static constexpr Room kOfOthers{20, 1U << 13U};

  /// What take() takes at most, of all pages that are not trusted.
  static constexpr Room kPerStep{64, 1U << 16U};

  void open(Peer& peer);
  void close(Peer& peer);

  /// A page is not trusted until this says so.
  void trust(Peer& peer, bool trusted);

  /// No effect for a page that is not open.
  void add(Peer& peer, std::string_view text);

  /// All messages of trusted pages, then of the others one each in turn, within kPerStep. The next call goes
  /// on with the next page. The messages of a page stay in order.
  [[nodiscard]] std::vector<std::pair<Peer*, std::string>> take();

 private:
  struct Box {
    bool trusted = false;
    std::size_t bytes = 0;
    std::deque<std::string> texts{};

    [[nodiscard]] std::string pop();
  };

  std::mutex mutex_;  ///< protects the members below
  std::map<Peer*, Box> boxes_;
  Peer* last_ = nullptr;  ///< of the pages that are not trusted, the one whose message was taken last
};

}  // namespace stilt::monitor
