#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "hal/can/frame.h"
#include "tests/hal/hex.h"

// Recorded behaviour of vendors' firmware; tests/data/traces/README.md describes the files.
namespace stilt::hal::testing {

struct TraceEvent {
  std::int64_t time_ns = 0;
  std::string kind;                ///< ">" to the driver, "<" from it, or what else is known at that time
  std::vector<std::string> words;  ///< after the kind

  [[nodiscard]] double number(std::size_t i) const { return std::stod(words.at(i)); }
  [[nodiscard]] int integer(std::size_t i) const { return std::stoi(words.at(i)); }
  /// Of ">" and "<": identifier and payload; the other flags are the protocol's.
  [[nodiscard]] CanFrame frame() const {
    CanFrame frame;
    frame.id = static_cast<std::uint32_t>(std::stoul(words.at(0), nullptr, 16));
    frame.extended = frame.id > kMaximumStandardId;
    return with_payload(frame, words.size() > 1 ? words.at(1) : "");
  }
};

/// The words from the first-th on.
inline std::string rest_of(const TraceEvent& event, std::size_t first) {
  std::string text;
  for (std::size_t i = first; i < event.words.size(); ++i) text += (text.empty() ? "" : " ") + event.words[i];
  return text;
}

struct TraceScenario {
  std::string name;
  std::map<std::string, double> settings;
  std::vector<TraceEvent> events;
};

/// All scenarios of a file; none when it cannot be read.
inline std::vector<TraceScenario> read_trace(const std::string& file) {
  std::vector<TraceScenario> scenarios;
  std::ifstream lines(std::string(STILT_TEST_DATA "/traces/") + file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first.empty() || first == "#") continue;
    if (first == "scenario") {
      scenarios.push_back({.name = line.substr(first.size() + 1), .settings = {}, .events = {}});
    } else if (first == "setting") {
      std::string key, value;
      words >> key >> value;
      scenarios.back().settings[key] = std::stod(value);
    } else {
      TraceEvent event{.time_ns = std::stoll(first) * 1000, .kind = {}, .words = {}};
      words >> event.kind;
      for (std::string word; words >> word;) event.words.push_back(word);
      scenarios.back().events.push_back(event);
    }
  }
  return scenarios;
}

}  // namespace stilt::hal::testing
