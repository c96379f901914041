#include "host_tools/web/monitor/terminal_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "firmware/supervisor/fault.h"
#include "silent_source.h"
#include "synthetic_source.h"

namespace stilt::monitor {
namespace {

std::string text_after_one_second(SyntheticSource& source, TerminalView& view) {
  source.advance(0.0);
  view.step(0.0);
  source.advance(1.2);
  view.step(1.2);
  return view.text(100, 40);
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(TerminalView, ShowsStateSpeedSolverTimingAndThatNoFaultIsThere) {
  SyntheticSource source;
  TerminalView view(source);
  const std::string text = text_after_one_second(source, view);
  for (const char* part : {"amber3m   live", "state     stand", "speed     +0.00 m/s", "solver    ", "wakeup",
                           "deadline 500 us", "faults    none"}) {
    EXPECT_TRUE(holds(text, part)) << part << " is not in\n" << text;
  }
}

/// Every text of a robot clears the screen, begins a line and writes to the clipboard.
class HostileSource final : public SampleSource {
 public:
  static constexpr const char* kText = "\x1b[2J\nfaults    none\r\x07\x7f\x9b\xc2\x9b \x1b]52;c;bHM=\x07 end";

  void poll(SampleSink& sink) override {
    ConfigurationSample configuration;
    configuration.robot = kText;
    sink.configuration(configuration);
    SupervisorSample supervisor;
    supervisor.commander = kText;
    supervisor.present = 1;
    supervisor.found[supervisor::kFaultTable[0].name] = kText;
    sink.supervisor(supervisor);
    TimingSample timing;
    timing.histograms.resize(1);
    timing.histograms[0].name = kText;
    sink.timing(timing);
    sink.event({0.0, kText, false});
  }
  void command(const Command&) override {}
  [[nodiscard]] std::string describe() const override { return "a hostile robot"; }
  [[nodiscard]] bool live() const override { return true; }
};

TEST(TerminalView, NoTextOfARobotCommandsTheTerminal) {
  HostileSource source;
  TerminalView view(source);
  view.step(0.0);
  for (const std::size_t columns : {40u, 300u}) {
    const std::string text = view.text(columns, 60);
    for (const char letter : text)
      EXPECT_TRUE(letter == '\n' || (letter >= 0x20 && letter < 0x7f)) << +letter;
    EXPECT_FALSE(holds(text, "\nfaults    none")) << text;
  }
  const std::string text = view.text(300, 60);
  std::size_t shown = 0;
  for (std::size_t at = 0; (at = text.find("?[2J?faults    none????? ?]52;c;bHM=? end", at)) != text.npos;
       ++at) {
    ++shown;
  }
  EXPECT_EQ(shown, 5u) << "robot, commander, finding, histogram and event in\n" << text;
}

TEST(TerminalView, AFaultSaysItsCauseAndWhatClearsIt) {
  SyntheticSource source;
  source.change("fault bus_off");
  TerminalView view(source);
  const std::string text = text_after_one_second(source, view);
  EXPECT_TRUE(holds(text, "FAULT     bus_off (now): the controller of a bus took itself off")) << text;
  EXPECT_TRUE(holds(text, "clears when: every bus is on; then reset")) << text;
}

TEST(TerminalView, AFaultSaysWhatItWasFoundBy) {
  SyntheticSource source;
  source.change("fault bus_off bus 1 of hardware.buses");
  TerminalView view(source);
  const std::string text = text_after_one_second(source, view);
  EXPECT_TRUE(holds(text, "took itself off\n          found: bus 1 of hardware.buses\n")) << text;
}

TEST(TerminalView, AFaultThatIsOverWaitsForItsReset) {
  SyntheticSource source;
  source.change("fault bus_off");
  TerminalView view(source);
  text_after_one_second(source, view);
  source.change("over bus_off");
  source.advance(1.4);
  view.step(1.4);
  EXPECT_TRUE(holds(view.text(100, 40), "FAULT     bus_off (waits for reset)")) << view.text(100, 40);
}

TEST(TerminalView, StaleDataAreCalledStale) {
  SyntheticSource source;
  TerminalView view(source);
  EXPECT_TRUE(holds(view.text(100, 40), "waiting for a controller"));
  text_after_one_second(source, view);
  source.change("silent");
  view.step(4.2);
  EXPECT_TRUE(holds(view.text(100, 40), "STALE DATA: none for 3.0 s")) << view.text(100, 40);
}

TEST(TerminalView, AControllerThatCannotBeReadIsNamedInsteadOfNothingReceived) {
  SilentSource source;
  TerminalView view(source);
  source.unreadable = "run 7 has other messages";
  view.step(0.0);
  EXPECT_TRUE(holds(view.text(200, 40), "NOTHING CAN BE SHOWN: run 7 has other messages"));
  source.news = [](SampleSink& sink) { sink.tick({}); };
  view.step(1.0);
  EXPECT_FALSE(holds(view.text(200, 40), "run 7")) << "another one is live";
  view.step(3.0);
  EXPECT_TRUE(holds(view.text(200, 40), "STALE DATA: none for 2.0 s; run 7 has other messages"));
}

TEST(TerminalView, NoLineIsLongerThanTheTerminal) {
  SyntheticSource source;
  source.change("fault joint_torque_limit");
  TerminalView view(source);
  text_after_one_second(source, view);
  std::size_t length = 0;
  for (const char letter : view.text(40, 40)) {
    length = letter == '\n' ? 0 : length + 1;
    EXPECT_LE(length, 40u);
  }
}

TEST(TerminalView, AtEightyColumnsUnitsAndSentencesGoOnInTheNextLine) {
  SyntheticSource source;
  source.change("fault bus_off");
  TerminalView view(source);
  text_after_one_second(source, view);
  const std::string text = std::regex_replace(view.text(60, 60), std::regex("\n {10}"), " ");
  for (const char* part : {"deadline 500 us", "clears when: every bus is on; then reset"}) {
    EXPECT_TRUE(holds(text, part)) << part << " is not whole in\n" << text;
  }
}

TEST(TerminalView, WhatHappensAgainAndAgainIsOneLineWithACount) {
  SyntheticSource source;
  TerminalView view(source);
  text_after_one_second(source, view);
  for (int k = 0; k < 30; ++k) {
    source.change("fault torque_loop_overrun");
    source.change("fault failed_solves");
  }
  source.advance(1.4);
  view.step(1.4);
  const std::string text = view.text(100, 60);
  EXPECT_TRUE(holds(text, "fault: torque_loop_overrun (30 times)")) << text;
  EXPECT_TRUE(holds(text, "fault: failed_solves (30 times)")) << text;
  EXPECT_TRUE(holds(text, "state: stand")) << text;
}

TEST(TerminalView, ASmallTerminalShowsStateAndFaultsAndLeavesOutTheRest) {
  SyntheticSource source;
  source.change("fault bus_off");
  TerminalView view(source);
  text_after_one_second(source, view);
  const std::string text = view.text(100, 7);
  EXPECT_EQ(std::ranges::count(text, '\n'), 7);
  EXPECT_TRUE(holds(text, "state     ")) << text;
  EXPECT_TRUE(holds(text, "FAULT     bus_off")) << text;
  EXPECT_FALSE(holds(text, "timing")) << text;
}

}  // namespace
}  // namespace stilt::monitor
