#pragma once

#include <array>
#include <string>
#include <string_view>

/// A page of two runs.
namespace stilt::report {

/// The data of a page of one run, as run_data_json() gives them; empty when it is no such page.
[[nodiscard]] std::string data_of_page(std::string_view page);

/// A run of a comparison.
struct ComparedRun {
  std::string name;  ///< shown, such as the file
  std::string data;  ///< of run_data_json()
};

/// A page with both runs: plots over each other, figures and differing settings side by side.
/// @param shift_s  added to all times of the second
[[nodiscard]] std::string render_comparison(const std::array<ComparedRun, 2>& runs, double shift_s);

}  // namespace stilt::report
