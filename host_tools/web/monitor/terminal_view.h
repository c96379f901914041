#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// Summary as text, for ssh: state, faults, speed, timing, solver. Plain lines, no colours in text(), and no
/// control characters but line feeds, whatever is received.
class TerminalView final : private SampleSink {
 public:
  explicit TerminalView(SampleSource& source) : source_(source) {}

  /// Reads the new samples.
  /// @param now_s  time of a steady clock, s
  void step(double now_s);

  /// The screen: at most `rows` lines of at most `columns` characters, each ending with a line feed.
  [[nodiscard]] std::string text(std::size_t columns, std::size_t rows) const;

 private:
  /// Largest number of events shown.
  static constexpr std::size_t kEvents = 12;

  /// An event, and how often it has happened while it was shown.
  struct Repeated {
    EventSample event;
    std::uint64_t times;
  };

  void configuration(const ConfigurationSample& sample) override;
  void tick(const TickSample& sample) override;
  void plan(const PlanSample&) override {}
  void planner(const PlannerSample& sample) override { cycle_ = sample; }
  void supervisor(const SupervisorSample& sample) override { supervisor_ = sample; }
  void event(const EventSample& sample) override;
  void timing(const TimingSample& sample) override { timing_ = sample; }
  void truth(const TruthSample&) override {}
  void reply(const ReplySample&) override {}

  [[nodiscard]] std::string link_text() const;
  [[nodiscard]] std::string state_text() const;
  [[nodiscard]] std::string fault_text() const;
  [[nodiscard]] std::string timing_text() const;

  SampleSource& source_;
  ConfigurationSample configuration_;
  std::optional<TickSample> tick_;
  std::optional<PlannerSample> cycle_;
  std::optional<SupervisorSample> supervisor_;
  std::optional<TimingSample> timing_;
  std::deque<Repeated> events_;
  std::uint64_t missing_ = 0;
  double speed_m_s_ = 0.0;  ///< mean over about the last second
  double now_s_ = 0.0;
  double received_s_ = 0.0;
};

/// Shows the summary on this terminal until q, Ctrl-C or the end of standard input. Returns the exit status.
[[nodiscard]] int run_terminal(SampleSource& source);

}  // namespace stilt::monitor
