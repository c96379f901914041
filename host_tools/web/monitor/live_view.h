#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/web/monitor/history.h"
#include "host_tools/web/monitor/page_commands.h"
#include "host_tools/web/monitor/page_inbox.h"
#include "host_tools/web/monitor/page_messages.h"
#include "host_tools/web/monitor/sample_source.h"
#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

/// The WebSocket /live: passes samples on to every open page, and commands of the pages to the source.
///
/// A page may command when it sends the run's token. A page that has sent the monitor's key may use the
/// tokens that the source has. Nothing follows from where a page is. The page whose order of motion was
/// accepted last is in command. While that page sends signs of life, several per second, the robot gets a
/// heartbeat.
class LiveView final : public Endpoint, private SampleSink {
 public:
  /// Seconds without a sign of life after which a page's heartbeat is no longer passed on.
  static constexpr double kPageSilence_s = 0.5;
  static constexpr double kHeartbeatPeriod_s = 0.08;
  static constexpr double kLinkPeriod_s = 0.1;

  /// Age of the newest link message of a page, up to which its orders are taken. Where the network stood
  /// still for longer, an order comes late, and its operator did not see what the robot did meanwhile.
  static constexpr double kOldestLink_s = 0.5;

  /// The same in signs of life: above it a page gets no tables until it has caught up. It counts transit to
  /// the page and back, and up to a period of either message. Above kOldestLink_s it gets no heartbeat
  /// either.
  static constexpr double kCatchUp_s = 0.3;

  /// Seconds after opening in which a page is busy with itself, and gets all tables.
  static constexpr double kOpening_s = 2.0;

  /// Commands of a page without reply; the one with the lowest number is forgotten.
  static constexpr std::size_t kAskedAtMost = 32;

  /// @param key  of the monitor; empty: no page may use the source's tokens
  LiveView(SampleSource& source, std::string key);

  /// Addresses of the page for other machines, shown to pages with the key. Before the first step.
  void set_urls(std::vector<std::string> urls) { urls_ = std::move(urls); }

  /// Reads and sends the new samples. Call some hundred times per second from one thread.
  /// @param now_s  time of a steady clock, s
  void step(double now_s);

  void opened(const std::shared_ptr<Peer>& peer) override;
  void received(Peer& peer, bool binary, std::string_view data) override;
  void closed(Peer& peer) override;

 private:
  /// A command without reply.
  struct Asked {
    CommandKind kind;
    std::optional<std::string> token;  ///< none: sent with several, and the reply does not say with which
  };

  struct Page {
    std::shared_ptr<Peer> peer;
    std::uint64_t commander = 0;
    double alive_s = 0.0;
    double opened_s = 0.0;
    double behind_s = 0.0;       ///< age of its newest link message when its last sign of life came
    std::uint64_t left_out = 0;  ///< tables, while it caught up
    std::string token{};         ///< of its last accepted command to the run that is shown
    std::map<std::uint32_t, Asked> asked{};  ///< by its numbers of them
    bool in_command = false;
    bool has_key = false;
    bool sent_has_token = false;  ///< in the last access message
  };

  void configuration(const ConfigurationSample& sample) override;
  void tick(const TickSample& sample) override;
  void plan(const PlanSample& sample) override;
  void planner(const PlannerSample& sample) override;
  void supervisor(const SupervisorSample& sample) override;
  void event(const EventSample& sample) override;
  void timing(const TimingSample& sample) override;
  void truth(const TruthSample& sample) override;
  void reply(const ReplySample& sample) override;

  void welcome_new_pages();
  void apply_page_commands(double now_s);
  void apply(Page& page, const std::string& text, double now_s);
  void rate(Page& page);
  void flush_tables(double now_s);
  void take_key(Page& page, const std::string& key);
  void replace_key(Page& page);
  void send_access(Page& page);
  void command(Page& page, PageMessage&& message);
  /// Why a page may not give this command now, one sentence; empty: it may.
  [[nodiscard]] std::string refusal(const Page& page, const PageMessage& message) const;
  [[nodiscard]] bool is_spoken_for(const Page& page) const;
  void choose(Page& page, const std::string& run_id);
  void play_from(double from_s);
  void hold(bool held);
  void send_heartbeats(double now_s);
  void note_link_status(double now_s);
  void send_link_status(double now_s);
  void send_link_status(const Page& page);
  void send(const SharedMessage& message);
  /// Whether that page gets no more tables now.
  [[nodiscard]] bool catches_up(const Page& page) const {
    return page.behind_s > kCatchUp_s && now_s_ - page.opened_s > kOpening_s;
  }
  [[nodiscard]] bool may_use_token(const Page& page) const { return page.has_key && source_.has_token(); }

  SampleSource& source_;
  std::string key_;
  std::vector<std::string> urls_;
  History history_;
  std::vector<TickSample> ticks_;
  std::vector<PlannerSample> cycles_;
  std::vector<TruthSample> truths_;
  std::string run_id_;
  LinkStatus link_;
  std::uint64_t next_tick_ = 0;
  bool ticks_follow_ = false;  ///< whether next_tick_ is known
  bool watched_ = false;       ///< whether a page has been open; a record starts with the first one
  double now_s_ = 0.0;
  double newest_s_ = 0.0;
  double heartbeat_s_ = -1.0;
  double link_s_ = -1.0;
  std::vector<Page> pages_;
  PageInbox inbox_;

  std::mutex mutex_;  ///< protects the members below
  std::vector<std::shared_ptr<Peer>> opened_;
  std::vector<Peer*> closed_;
};

}  // namespace stilt::monitor
