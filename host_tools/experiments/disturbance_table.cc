#include "host_tools/experiments/disturbance.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

/// "0.502", or "0.707, not at the command" for a row that does not reach its command.
std::string speed(const Json& row) {
  const std::string measured = cell(row.at("unpushed_speed_m_s"), "%.3f");
  return row.at("walks").get<bool>() ? measured : measured + ", not at the command";
}

std::string gait(const Json& row) {
  const auto name = row.at("gait").get<std::string>();
  return name == "walk" ? name + " " + cell(row.at("speed_m_s"), "%.1f") : name;
}

std::string steps(const Json& row) {
  if (row.at("step_length_range_m").is_null()) return "-";
  return cell(row.at("step_length_range_m"), "%.2f") + " (" + cell(row.at("step_length_min_m"), "%.2f") +
         " to " + cell(row.at("step_length_max_m"), "%.2f") + ")";
}

std::string steps_at_20N(const Json& row) {
  const Json& range = row.at("step_length_at_20N_m");
  return range.is_null() ? "-" : cell(range.at("range"), "%.2f");
}

/// "1, 3 at 80 N": median and largest number of steps, and the push.
std::string recovery(const Json& steps) {
  if (steps.is_null()) return "-";
  return cell(steps.at("median"), "%.0f", "none") + ", " + cell(steps.at("max"), "%.0f", "none") + " at " +
         cell(steps.at("force_N"), "%.0f") + " N";
}

}  // namespace

std::string disturbance_table(const Json& merged) {
  std::string table =
      "| row | controller | horizon s | gait | push | all phases N | half of them N | paper N | "
      "unpushed m/s | step lengths m | their range at 20 N | recovery in steps, median, max | "
      "first slip N | saturated s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    const Json& recoveries = row.at("recovery_steps");
    table += "| " + row.at("name").get<std::string>() + " | " + row.at("controller").get<std::string>() +
             " | " + cell(row.at("horizon_s"), "%.1f") + " | " + gait(row) + " | " +
             row.value("push_at", std::string("hip")) + " " + row.at("direction").get<std::string>() + " | " +
             cell(row.at("push_all_phases_N"), "%.0f", "falls unpushed") + " | " +
             cell(row.at("push_half_phases_N"), "%.0f", "falls unpushed") + " | " +
             cell(row.at("paper_N"), "%.0f") + " | " + speed(row) + " | " + steps(row) + " | " +
             steps_at_20N(row) + " | " + recovery(recoveries.at("at_20N")) + "; " +
             recovery(recoveries.at("at_80_percent")) + " | " + cell(row.at("first_slip_N"), "%.0f", "none") +
             " | " + cell(row.at("saturated_s"), "%.2f") + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
