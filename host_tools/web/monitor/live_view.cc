#include "host_tools/web/monitor/live_view.h"

#include <algorithm>
#include <cstdio>
#include <random>

#include "firmware/telemetry/secret.h"

namespace stilt::monitor {
namespace {

std::uint64_t random_number() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 32U) | device();
}

}  // namespace

LiveView::LiveView(SampleSource& source, std::string key) : source_(source), key_(std::move(key)) {}

void LiveView::step(double now_s) {
  now_s_ = now_s;
  welcome_new_pages();
  send_heartbeats(now_s);  // first: nothing that pages send delays them
  apply_page_commands(now_s);
  if (source_.live() || watched_) source_.poll(*this);
  flush_tables(now_s);
  if (now_s - link_s_ >= kLinkPeriod_s) send_link_status(now_s);
}

void LiveView::opened(const std::shared_ptr<Peer>& peer) {
  inbox_.open(*peer);
  const std::lock_guard lock(mutex_);
  opened_.push_back(peer);
}

void LiveView::received(Peer& peer, bool binary, std::string_view data) {
  if (!binary) inbox_.add(peer, data);
}

void LiveView::closed(Peer& peer) {
  inbox_.close(peer);
  const std::lock_guard lock(mutex_);
  closed_.push_back(&peer);
}

void LiveView::welcome_new_pages() {
  std::vector<std::shared_ptr<Peer>> opened;
  std::vector<Peer*> closed;
  {
    const std::lock_guard lock(mutex_);
    opened.swap(opened_);
    closed.swap(closed_);
  }
  for (auto& peer : opened) {
    pages_.push_back({.peer = peer, .commander = random_number(), .alive_s = now_s_, .opened_s = now_s_});
    peer->send(hello_message(source_));
    note_link_status(now_s_);
    send_link_status(pages_.back());  // before the history, whose way the page's answer then measures
    history_.send_to(*peer);
    watched_ = true;
  }
  std::erase_if(pages_, [&](const Page& page) {
    const bool is_closed = std::ranges::find(closed, page.peer.get()) != closed.end();
    if (is_closed) source_.forget(page.commander);
    return is_closed;
  });
}

void LiveView::apply_page_commands(double now_s) {
  for (const auto& [peer, text] : inbox_.take()) {
    const auto page = std::find_if(pages_.begin(), pages_.end(),
                                   [wanted = peer](const Page& one) { return one.peer.get() == wanted; });
    if (page != pages_.end()) apply(*page, text, now_s);
  }
}

/// A page with the key, or with a token that the robot took, is trusted. It keeps its connection, however
/// many others connect, and its messages come before theirs.
void LiveView::rate(Page& page) {
  const bool trusted = page.has_key || !page.token.empty();
  page.peer->hold(trusted);
  inbox_.trust(*page.peer, trusted);
}

void LiveView::apply(Page& page, const std::string& text, double now_s) {
  page.alive_s = now_s;
  auto message = parse_page_message(text);
  if (!message) {
    page.peer->send(reply_message(0, false, message.error()));
    return;
  }
  if (!message->is_command && message->link_time_s) page.behind_s = now_s - *message->link_time_s;
  if (!message->key.empty()) take_key(page, message->key);
  if (message->new_key && page.has_key) replace_key(page);
  if (message->from_s && !source_.live()) play_from(*message->from_s);
  if (message->hold && !source_.live()) hold(*message->hold);
  if (!message->run.empty()) choose(page, message->run);
  if (message->is_command) command(page, std::move(*message));
}

std::string LiveView::refusal(const Page& page, const PageMessage& message) const {
  const Command& command = message.command;
  if (!source_.live()) return "This is a record: it takes no commands.";
  if (command.token.empty() && !may_use_token(page)) {
    return page.has_key
               ? "A token is needed: the monitor cannot read that of this run."
               : "This page only looks: open the link that stilt monitor printed, or enter the token "
                 "of the run.";
  }
  const double age_s = now_s_ - message.link_time_s.value_or(now_s_);
  if (age_s <= kOldestLink_s || telemetry::is_of_everybody(command.kind)) return {};
  char text[128];
  std::snprintf(
      text, sizeof text,
      "The sender's data were %.1f s old when this order came, %.1f s at most: look, then order again.",
      age_s, kOldestLink_s);
  return text;
}

void LiveView::command(Page& page, PageMessage&& message) {
  Command& command = message.command;
  if (const std::string reason = refusal(page, message); !reason.empty()) {
    page.peer->send(reply_message(command.sequence, false, reason));
    return;
  }
  command.commander = page.commander;
  command.with_known_tokens = page.has_key;
  const bool with_several = page.has_key && telemetry::is_of_everybody(command.kind);
  page.asked[command.sequence] = {command.kind, with_several ? std::nullopt : std::optional(command.token)};
  if (page.asked.size() > kAskedAtMost) page.asked.erase(page.asked.begin());
  source_.command(command);
}

void LiveView::take_key(Page& page, const std::string& key) {
  page.has_key = telemetry::same_secret(key, key_);
  rate(page);
  send_access(page);
}

/// Ends what every other page may do by the old key.
void LiveView::replace_key(Page& page) {
  key_ = telemetry::random_secret();
  for (Page& other : pages_) {
    if (other.peer == page.peer || !other.has_key) continue;
    other.has_key = false;
    other.in_command = other.in_command && !other.token.empty();
    rate(other);
    send_access(other);
  }
  page.has_key = !key_.empty();
  send_access(page);
}

void LiveView::send_access(Page& page) {
  page.sent_has_token = source_.has_token();
  page.peer->send(access_message({page.has_key, page.sent_has_token, page.has_key ? key_ : std::string(),
                                  page.has_key ? urls_ : std::vector<std::string>()}));
}

/// Whether the robot gets heartbeats for a page: of one that is silent, or has lost its rights, it gets none.
bool LiveView::is_spoken_for(const Page& page) const {
  if (!page.in_command || now_s_ - page.alive_s > kPageSilence_s) return false;
  return page.has_key || !page.token.empty();
}

/// All pages show one run. It changes for a page that is trusted, and not under a page that commands.
void LiveView::choose(Page& page, const std::string& run_id) {
  if (!page.has_key && page.token.empty()) {
    page.peer->send(reply_message(0, false, "This page only looks: it shows the robot that is commanded."));
    return;
  }
  const bool another_commands = std::ranges::any_of(
      pages_, [&](const Page& one) { return is_spoken_for(one) && one.peer != page.peer; });
  if (another_commands) {
    page.peer->send(reply_message(0, false, "Another page commands the robot that is shown."));
    return;
  }
  source_.choose(run_id);
}

/// All pages show the record from that time on, as after opening the page.
void LiveView::play_from(double from_s) {
  source_.play_from(from_s);
  history_ = {};
  ticks_.clear();
  cycles_.clear();
  truths_.clear();
  run_id_.clear();
  link_ = {};
  ticks_follow_ = false;
  for (const Page& page : pages_) page.peer->send(hello_message(source_));
}

/// Reported to all pages at once.
void LiveView::hold(bool held) {
  source_.hold(held);
  send_link_status(now_s_);
}

void LiveView::send(const SharedMessage& message) {
  for (Page& page : pages_) {
    if (message->droppable && catches_up(page)) {
      ++page.left_out;
    } else {
      page.peer->send(message);
    }
  }
}

void LiveView::configuration(const ConfigurationSample& sample) {
  if (sample.run_id != run_id_) {
    flush_tables(now_s_);
    history_.clear_run();
    run_id_ = sample.run_id;
    ticks_follow_ = false;
    ++link_.runs;
    for (Page& page : pages_) {
      page.in_command = false;
      page.token.clear();
      page.asked.clear();
      rate(page);
    }
  }
  const SharedMessage message = configuration_message(sample);
  history_.configuration(message);
  send(message);
}

void LiveView::tick(const TickSample& sample) {
  if (ticks_follow_ && sample.record.tick > next_tick_) link_.missing += sample.record.tick - next_tick_;
  ticks_follow_ = true;
  next_tick_ = sample.record.tick + 1;
  ++link_.ticks;
  link_.emergency_stop = hal::name(sample.record.emergency_stop);
  link_.received = true;
  newest_s_ = now_s_;
  ticks_.push_back(sample);
}

void LiveView::plan(const PlanSample& sample) {
  if (sample.nodes.empty()) return;
  const SharedMessage message = plan_message(sample);
  history_.plan(message);
  send(message);
}

void LiveView::planner(const PlannerSample& sample) { cycles_.push_back(sample); }

void LiveView::truth(const TruthSample& sample) { truths_.push_back(sample); }

void LiveView::supervisor(const SupervisorSample& sample) {
  const SharedMessage message = supervisor_message(sample);
  history_.supervisor(message);
  send(message);
}

void LiveView::event(const EventSample& sample) {
  const SharedMessage message = event_message(sample);
  history_.event(message);
  send(message);
}

void LiveView::timing(const TimingSample& sample) {
  const SharedMessage message = timing_message(sample);
  history_.timing(message);
  send(message);
}

void LiveView::reply(const ReplySample& sample) {
  const auto page = std::find_if(pages_.begin(), pages_.end(),
                                 [&](const Page& one) { return one.commander == sample.commander; });
  if (page == pages_.end()) return;
  if (!sample.proven) {  // shown, but it ends no waiting for the robot's own
    page->peer->send(reply_message(sample.sequence, false, sample.reason, false));
    return;
  }
  const auto asked = page->asked.extract(sample.sequence);
  if (sample.accepted && !asked.empty()) {
    if (telemetry::makes_commander(asked.mapped().kind)) {
      for (Page& other : pages_) other.in_command = false;
      page->in_command = true;
    }
    if (asked.mapped().token) page->token = *asked.mapped().token;
    rate(*page);
  }
  page->peer->send(reply_message(sample.sequence, sample.accepted, sample.reason));
}

void LiveView::flush_tables(double now_s) {
  const auto flush = [&](auto& samples, auto message_of) {
    if (samples.empty()) return;
    const SharedMessage message = message_of(samples);
    history_.table(now_s, message);
    send(message);
    samples.clear();
  };
  flush(ticks_, [](const auto& samples) { return ticks_message(samples); });
  flush(cycles_, [](const auto& samples) { return planner_message(samples); });
  flush(truths_, [](const auto& samples) { return truth_message(samples); });
}

void LiveView::send_heartbeats(double now_s) {
  if (now_s - heartbeat_s_ < kHeartbeatPeriod_s) return;
  heartbeat_s_ = now_s;
  for (const Page& page : pages_) {
    if (!is_spoken_for(page) || page.behind_s > kOldestLink_s) continue;
    Command heartbeat;
    heartbeat.commander = page.commander;
    heartbeat.token = page.token;
    source_.command(heartbeat);
  }
}

void LiveView::note_link_status(double now_s) {
  link_.time_s = now_s;
  link_.of_others = source_.of_others();
  link_.talking = source_.talking();
  link_.refused = source_.refused();
  link_.playback = source_.playback();
  link_.silent_s = link_.received ? now_s - newest_s_ : 0.0;
}

void LiveView::send_link_status(double now_s) {
  link_s_ = now_s;
  note_link_status(now_s);
  for (Page& page : pages_) {
    if (page.sent_has_token != source_.has_token()) send_access(page);
    send_link_status(page);
  }
}

void LiveView::send_link_status(const Page& page) {
  link_.not_sent = page.peer->dropped() + page.left_out;
  link_.behind_s = page.behind_s;
  page.peer->send(link_message(link_));
}

}  // namespace stilt::monitor
