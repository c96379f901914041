#include "host_tools/experiments/disturbance.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

std::string gait(const Json& row) {
  const auto name = row.at("gait").get<std::string>();
  return name == "walk" ? name + " " + cell(row.at("speed_m_s"), "%.1f") : name;
}

/// "0.07 to 0.45": smallest and largest.
std::string step_lengths(const Json& row) {
  if (row.at("step_length_range_m").is_null()) return "-";
  return cell(row.at("step_length_min_m"), "%.2f") + " to " + cell(row.at("step_length_max_m"), "%.2f");
}

std::string step_ranges(const Json& row) {
  const Json& at_20N = row.at("step_length_at_20N_m");
  return cell(row.at("step_length_range_m"), "%.2f") + ", " +
         (at_20N.is_null() ? "-" : cell(at_20N.at("range"), "%.2f"));
}

/// "1, 3": median and largest number of steps.
std::string recovery(const Json& steps) {
  if (steps.is_null()) return "-";
  return cell(steps.at("median"), "%.0f", "none") + ", " + cell(steps.at("max"), "%.0f", "none");
}

}  // namespace

std::string disturbance_table(const Json& merged) {
  std::string table =
      "| row | controller | horizon s | gait | push | speed unpushed m/s | walks | all N | half N | paper N "
      "| "
      "step lengths m (all runs survived) | range m: all, at 20 N | "
      "steps to recover from 20 N: median, most | from 80 % of all N | a foot slips from N | "
      "motors at the limit s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    const Json& recoveries = row.at("recovery_steps");
    table +=
        "| " + row.at("name").get<std::string>() + " | " + row.at("controller").get<std::string>() + " | " +
        cell(row.at("horizon_s"), "%.1f") + " | " + gait(row) + " | " +
        row.value("push_at", std::string("hip")) + " " + row.at("direction").get<std::string>() + " | " +
        cell(row.at("unpushed_speed_m_s"), "%.3f") + " | " + (row.at("walks").get<bool>() ? "yes" : "no") +
        " | " + cell(row.at("push_all_phases_N"), "%.0f", "falls unpushed") + " | " +
        cell(row.at("push_half_phases_N"), "%.0f", "falls unpushed") + " | " +
        cell(row.at("paper_N"), "%.0f") + " | " + step_lengths(row) + " | " + step_ranges(row) + " | " +
        recovery(recoveries.at("at_20N")) + " | " + recovery(recoveries.at("at_80_percent")) + " | " +
        cell(row.at("first_slip_N"), "%.0f", "none") + " | " + cell(row.at("saturated_s"), "%.2f") + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
