#include "host_tools/web/monitor/terminal_view.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "host_tools/web/monitor/printable.h"

namespace stilt::monitor {
namespace {

constexpr double kStale_s = 0.5;
constexpr double kSpeedMemory_s = 0.5;

/// Values come from the network: none may command the terminal or end the line.
template <class... Values>
std::string line(const char* format, Values... values) {
  char buffer[300];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return printable(buffer) + "\n";
}

/// Breaks lines at spaces, continuing under the second column, and drops lines below the last row, so that
/// the terminal neither wraps nor scrolls. A character that is cut in two becomes two question marks.
std::string fitted(const std::string& text, std::size_t columns, std::size_t rows) {
  constexpr std::size_t kIndent = 10;
  std::string out;
  std::size_t lines = 0;
  std::istringstream all(text);
  for (std::string rest; lines < rows && std::getline(all, rest); ++lines) {
    while (rest.size() > columns && lines + 1 < rows) {
      const std::size_t space = rest.rfind(' ', columns);
      const bool at_word = space != std::string::npos && space > kIndent;
      out += printable(rest.substr(0, at_word ? space : columns)) + '\n';
      rest = (columns > 2 * kIndent ? std::string(kIndent, ' ') : "") +
             rest.substr(at_word ? space + 1 : columns);
      ++lines;
    }
    out += printable(rest.substr(0, columns)) + '\n';
  }
  return out;
}

std::string duration(double us) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, us < 1000.0 ? "%.0f us" : "%.2f ms", us < 1000.0 ? us : 1e-3 * us);
  return buffer;
}

}  // namespace

void TerminalView::step(double now_s) {
  now_s_ = now_s;
  source_.poll(*this);
}

void TerminalView::configuration(const ConfigurationSample& sample) {
  if (sample.run_id != configuration_.run_id) {
    tick_.reset();
    cycle_.reset();
    supervisor_.reset();
    timing_.reset();
    events_.clear();
  }
  configuration_ = sample;
}

void TerminalView::tick(const TickSample& sample) {
  const std::uint64_t number = sample.record.tick;
  if (tick_ && number > tick_->record.tick + 1) missing_ += number - tick_->record.tick - 1;
  const double share = tick_ ? std::clamp((sample.time_s - tick_->time_s) / kSpeedMemory_s, 0.0, 1.0) : 1.0;
  speed_m_s_ += share * (sample.record.estimated_state[7] - speed_m_s_);
  tick_ = sample;
  received_s_ = now_s_;
}

/// What happens again is one line with a count, the newest on top.
void TerminalView::event(const EventSample& sample) {
  std::uint64_t times = 1;
  const auto before =
      std::ranges::find_if(events_, [&](const Repeated& one) { return one.event.text == sample.text; });
  if (before != events_.end()) {
    times += before->times;
    events_.erase(before);
  }
  events_.push_front({sample, times});
  if (events_.size() > kEvents) events_.pop_back();
}

std::string TerminalView::link_text() const {
  const std::string refused = source_.refused();
  if (!tick_ && !refused.empty()) return "NOTHING CAN BE SHOWN: " + refused;
  if (!tick_) return "waiting for a controller: nothing received yet from " + source_.describe();
  const double silent_s = now_s_ - received_s_;
  if (source_.live() && silent_s > kStale_s) {
    char text[80];
    std::snprintf(text, sizeof text, "STALE DATA: none for %.1f s", silent_s);
    return refused.empty() ? text : std::string(text) + "; " + refused;
  }
  std::string text = source_.live() ? "live" : "record";
  const std::uint64_t lost = missing_ + (timing_ ? timing_->dropped : 0);
  if (lost > 0) text += ", " + std::to_string(lost) + " lost";
  if (source_.of_others() > 0) text += ", another controller sends, too";
  return text;
}

std::string TerminalView::fault_text() const {
  const std::uint64_t any = supervisor_->present | supervisor_->latched;
  if (any == 0) return "faults    none\n";
  std::string text;
  for (std::size_t row = 0; row < supervisor::kFaults; ++row) {
    const std::uint64_t bit = std::uint64_t{1} << row;
    if ((any & bit) == 0) continue;
    const supervisor::FaultRow& fault = supervisor::kFaultTable[row];
    const auto found = supervisor_->found.find(fault.name);
    const bool known = found != supervisor_->found.end() && !found->second.empty();
    text += line("FAULT     %s (%s): %s", fault.name,
                 (supervisor_->present & bit) ? "now" : "waits for reset", fault.cause);
    if (known) text += line("          found: %s", found->second.c_str());
    text += line("          clears when: %s%s", fault.clears,
                 fault.severity == supervisor::Severity::latched ? "; then reset" : "");
  }
  return text;
}

std::string TerminalView::timing_text() const {
  std::string text = line("timing    %llu ticks, %llu late", static_cast<unsigned long long>(timing_->ticks),
                          static_cast<unsigned long long>(timing_->late_ticks));
  for (const HistogramSample& histogram : timing_->histograms) {
    text += line("          %-15s p50 %-9s p99 %-9s max %-9s deadline %s", histogram.name.c_str(),
                 duration(histogram.p50_us).c_str(), duration(histogram.p99_us).c_str(),
                 duration(histogram.max_us).c_str(),
                 histogram.deadline_us > 0.0 ? duration(histogram.deadline_us).c_str() : "-");
  }
  return text;
}

std::string TerminalView::state_text() const {
  const auto state = static_cast<supervisor::State>(supervisor_->state);
  const auto level = static_cast<supervisor::FallbackLevel>(supervisor_->fallback_level);
  std::string follows = name(level);
  std::ranges::replace(follows, '_', ' ');
  std::string text = line("state     %s (%s); %s", name(state), description(state), follows.c_str());
  const bool walks = supervisor_->gait == 2;
  const char* who = supervisor_->commander.empty() ? "no commander" : supervisor_->commander.c_str();
  const char* silent = supervisor_->commander.empty() || supervisor_->commander_alive ? "" : " (silent)";
  text += walks ? line("command   walk %.2f m/s, %s%s", supervisor_->speed_m_s, who, silent)
                : line("command   %s, %s%s", supervisor_->gait == 1 ? "step" : "stand", who, silent);
  return text;
}

/// Most important lines first, because a small terminal shows no others.
std::string TerminalView::text(std::size_t columns, std::size_t rows) const {
  std::string text =
      line("stilt monitor   %s   %s", configuration_.robot.c_str(), link_text().c_str()) + "\n";
  if (supervisor_) text += state_text();
  if (tick_) {
    const auto& state = tick_->record.estimated_state;
    text += tick_->record.stance_episode == 0
                ? line("speed     -   off its feet   pitch %+.3f rad", state[2])
                : line("speed     %+.2f m/s   x %.2f m   hip %.3f m   pitch %+.3f rad", speed_m_s_, state[0],
                       state[1], state[2]);
  }
  if (supervisor_) text += fault_text();
  if (cycle_) {
    text +=
        line("solver    %d iterations, %s, defect %.1e, equalities %.1e", cycle_->iterations,
             duration(cycle_->solve_us).c_str(), cycle_->dynamics_defect_max, cycle_->equality_violation_max);
  }
  if (timing_) text += timing_text();
  for (const auto& [event, times] : events_) {
    const std::string again = times > 1 ? " (" + std::to_string(times) + " times)" : "";
    text += line("%8.2f  %s%s", event.time_s, event.text.c_str(), again.c_str());
  }
  return fitted(text, columns, rows);
}

}  // namespace stilt::monitor
