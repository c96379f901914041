#pragma once

#include <deque>
#include <map>
#include <string>

#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// A robot made of a few sines instead of physics. It stands, steps and walks on command, at the commanded
/// speed, and publishes like stiltd. For tests of the page. Its time is that given to advance().
class SyntheticSource final : public SampleSource {
 public:
  static constexpr const char* kToken = "open-sesame";

  SyntheticSource();

  /// Ticks up to `now_s` of any steady clock are there at the next poll().
  void advance(double now_s);

  /// Changes something, in words: "silent", "talk", "fault NAME FOUND", "over NAME", "drop N", "run",
  /// "others", "push N", "idle", "dead", "record". "forge REASON" refuses each command without proof and
  /// keeps the own replies back until "answer". Throws std::invalid_argument when it is none of them.
  void change(const std::string& words);

  void poll(SampleSink& sink) override;
  void command(const Command& command) override;
  [[nodiscard]] std::string describe() const override { return "a synthetic robot"; }
  [[nodiscard]] bool live() const override { return live_; }
  [[nodiscard]] bool has_token() const override { return true; }
  [[nodiscard]] std::vector<SendingRun> talking() const override;
  void choose(const std::string& run_id) override;

 private:
  [[nodiscard]] std::string run() const { return "synthetic-" + std::to_string(run_id_); }
  void begin_run(int run_id);
  [[nodiscard]] std::string refusal(const Command& command) const;
  void apply(const Command& command);
  void tick(SampleSink& sink);
  void introduce(SampleSink& sink);
  void say_slowly(SampleSink& sink);
  void publish_event(const std::string& text, bool serious);
  [[nodiscard]] PlanNodeSample node(double ahead_s) const;
  [[nodiscard]] gait::GaitCommand commanded_gait() const;
  [[nodiscard]] SupervisorSample supervisor_sample() const;
  [[nodiscard]] TimingSample timing_sample() const;

  double now_s_ = -1.0, start_s_ = -1.0;
  bool joints_answer_ = true;
  bool silent_ = false, live_ = true, introduce_ = true;
  int run_id_ = 1;
  int other_run_id_ = 0;  ///< of a controller that publishes, too; 0: none
  std::uint64_t ticks_ = 0;
  double base_x_m_ = 0.0, speed_m_s_ = 0.0, wanted_m_s_ = 0.0, phase_ = 0.0, push_N_ = 0.0;
  int state_ = 4;  ///< stands
  std::uint64_t present_ = 0, latched_ = 0;
  std::map<std::string, std::string> found_;
  double swing_height_m_ = 0.06, hip_height_m_ = 0.78;
  std::deque<ReplySample> replies_;
  std::string forged_;                 ///< reason of forged refusals; empty: there are none
  std::deque<ReplySample> kept_back_;  ///< own replies meanwhile
  std::deque<EventSample> events_;
};

}  // namespace stilt::monitor
