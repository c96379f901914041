#pragma once

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "host_tools/experiments/job_folder.h"

/// What the guards of docs/results share.
namespace stilt::testing_support {

/// Share of a published force or margin that has to be survived.
inline constexpr double kGuardedShare = 0.85;
inline constexpr double kSameSpeed_m_s = 0.02;

/// A file of docs/results; {rows: [], sequences: []} when it cannot be read, which a test reports.
[[nodiscard]] inline experiments::Json results_of(const std::string& table) {
  std::ifstream file(STILT_RESULTS "/" + table + ".json");
  experiments::Json json = experiments::Json::parse(file, nullptr, false);
  if (!json.is_discarded()) return json;
  return {{"rows", experiments::Json::array()}, {"sequences", experiments::Json::array()}};
}

/// The name of a parameterised test: letters and digits of a text.
[[nodiscard]] inline std::string test_name(std::string text) {
  std::ranges::replace_if(text, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return text;
}

}  // namespace stilt::testing_support
