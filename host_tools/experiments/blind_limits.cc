#include "host_tools/experiments/blind_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_tools/experiments/command_sequence.h"
#include "host_tools/experiments/table_text.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::experiments {
namespace {

/// Removes the last digits of a sum of decimal fractions.
double rounded(double value) { return std::round(value * 1e9) / 1e9; }

Json fall_json(const log::RunSummary& summary) {
  return summary.survived ? Json(nullptr) : Json(summary.fall_time_s);
}

std::string prefix(const LimitPlan::Controller& controller) {
  return controller.name + "_" + simulation::decimals_text(controller.horizon_s) + "s_";
}

WalkCase walk_of(const LimitPlan& plan, const LimitPlan::Controller& controller, int seed) {
  WalkCase walk;
  walk.controller = controller.name;
  walk.horizon_s = controller.horizon_s;
  walk.command.speed_m_s = plan.speed_m_s;
  walk.duration_s = plan.duration_s;
  walk.seed = static_cast<std::uint64_t>(seed);
  return walk;
}

double value_of(const BlindQuantity& quantity, double tried) { return rounded(quantity.nominal + tried); }

Json run_limit(const LimitPlan& plan, const LimitPlan::Controller& controller, const BlindQuantity& quantity,
               int phase, int seed, const WalkRunner& run) {
  Json trials = Json::array();
  const Limit limit = find_limit(quantity.search, [&](double tried) {
    const WalkCase walk = limit_case(plan, controller, quantity, phase, seed, value_of(quantity, tried));
    const log::RunSummary summary = run(walk).summary;
    const bool passed = quantity.passes(walk, summary);
    trials.push_back({{"value", value_of(quantity, tried)},
                      {"passed", passed},
                      {"survived", summary.survived},
                      {"fall_time_s", fall_json(summary)},
                      {"mean_speed_m_s", summary.mean_speed_m_s}});
    return passed;
  });
  const auto value = [&](const std::optional<double>& tried) {
    return tried ? Json(value_of(quantity, *tried)) : Json(nullptr);
  };
  return {{"phase", phase},
          {"seed", seed},
          {"limit", value(limit.passed)},
          {"first_fall", value(limit.failed)},
          {"trials", std::move(trials)}};
}

Json run_sequence(const LimitPlan& plan, const LimitPlan::Controller& controller, int seed,
                  const WalkRunner& run) {
  const WalkCase walk = sequence_case(plan, controller, seed);
  const log::RunSummary summary = run(walk).summary;
  Json commands = {{{"start_s", 0.0},
                    {"gait", simulation::gait_name(walk.command.kind)},
                    {"speed_m_s", walk.command.speed_m_s}}};
  for (const simulation::TimedCommand& timed : walk.later_commands) {
    commands.push_back({{"start_s", timed.start_s},
                        {"gait", simulation::gait_name(timed.command.kind)},
                        {"speed_m_s", timed.command.speed_m_s}});
  }
  return {{"seed", seed},
          {"survived", summary.survived},
          {"fall_time_s", fall_json(summary)},
          {"commands", std::move(commands)}};
}

int phases_of(const LimitPlan& plan, const BlindQuantity& quantity) {
  return quantity.has_phases ? plan.phases : 1;
}

/// The row of one quantity from the results of its cases.
class RowSummary {
 public:
  void add(const Json& result) {
    cases_.push_back(
        {{"phase", result.at("phase")}, {"seed", result.at("seed")}, {"limit", result.at("limit")}});
    if (!result.at("first_fall").is_null()) ++falls_;
    for (const Json& trial : result.at("trials")) {
      if (trial.at("value") != result.at("limit")) continue;
      const double speed_m_s = trial.at("mean_speed_m_s").get<double>();
      speed_min_m_s_ = std::min(speed_min_m_s_, speed_m_s);
      speed_max_m_s_ = std::max(speed_max_m_s_, speed_m_s);
    }
  }

  [[nodiscard]] Json row(const LimitPlan& plan, const LimitPlan::Controller& controller,
                         const BlindQuantity& quantity, int phases) {
    std::ranges::stable_sort(cases_, {}, [&](const Json& one) {
      const Json& limit = one.at("limit");
      return limit.is_null() ? -1.0 : std::abs(limit.get<double>() - quantity.nominal);
    });
    Json limits = Json::array();
    Json worst = Json::array();
    for (const Json& one : cases_) {
      limits.push_back(one.at("limit"));
      if (worst.size() < 2) worst.push_back(one);
    }
    const LimitSearch& search = quantity.search;
    const double steps = std::floor(search.largest / search.coarse + 1e-9);
    const bool any = speed_max_m_s_ >= speed_min_m_s_;
    return {{"controller", controller.name},
            {"horizon_s", controller.horizon_s},
            {"duration_s", plan.duration_s},
            {"speed_m_s", plan.speed_m_s},
            {"name", quantity.name},
            {"quantity", quantity.quantity},
            {"unit", quantity.unit},
            {"direction", quantity.direction},
            {"nominal", quantity.nominal},
            {"limit_all", limits.front()},
            {"limit_half", limits[limits.size() / 2]},
            {"phases", phases},
            {"cases", limits.size()},
            {"falls", falls_},
            {"coarse", std::abs(search.coarse)},
            {"fine", std::abs(search.fine)},
            {"last_tried", value_of(quantity, steps * search.coarse)},
            {"speed_min_m_s", any ? Json(speed_min_m_s_) : Json(nullptr)},
            {"speed_max_m_s", any ? Json(speed_max_m_s_) : Json(nullptr)},
            {"limits", limits},
            {"worst_cases", worst}};
  }

 private:
  std::vector<Json> cases_;
  int falls_ = 0;
  double speed_min_m_s_ = std::numeric_limits<double>::max();
  double speed_max_m_s_ = std::numeric_limits<double>::lowest();
};

}  // namespace

WalkCase limit_case(const LimitPlan& plan, const LimitPlan::Controller& controller,
                    const BlindQuantity& quantity, int phase, int seed, double value) {
  const double step_m = plan.speed_m_s * controller.step_time_s;
  const double phase_m = step_m * (phase % 2 + static_cast<double>(phase) / plan.phases);
  WalkCase walk = walk_of(plan, controller, seed);
  quantity.apply(value, phase_m, walk);
  return walk;
}

WalkCase sequence_case(const LimitPlan& plan, const LimitPlan::Controller& controller, int seed) {
  WalkCase walk = walk_of(plan, controller, seed);
  walk.duration_s = plan.sequence_s;
  const std::vector<simulation::TimedCommand> sequence =
      random_commands(static_cast<std::uint32_t>(seed), plan.sequence_s);
  walk.command = sequence.front().command;
  walk.later_commands.assign(sequence.begin() + 1, sequence.end());
  return walk;
}

std::vector<Job> limit_jobs(const LimitPlan& plan, const WalkRunner& run) {
  std::vector<Job> jobs;
  for (const LimitPlan::Controller& controller : plan.controllers) {
    for (const BlindQuantity& quantity : plan.quantities) {
      const int phases = phases_of(plan, quantity);
      for (int phase = 0; phase < phases; ++phase) {
        for (int seed = 1; seed <= plan.seeds; ++seed) {
          const std::string id = prefix(controller) + quantity.name + "_phase" + std::to_string(phase) +
                                 "of" + std::to_string(phases) + "_seed" + std::to_string(seed);
          jobs.push_back({id, [=] { return run_limit(plan, controller, quantity, phase, seed, run); }});
        }
      }
    }
    for (int seed = 1; seed <= plan.sequences; ++seed) {
      jobs.push_back({prefix(controller) + "commands_" + std::to_string(seed),
                      [=] { return run_sequence(plan, controller, seed, run); }});
    }
  }
  return jobs;
}

Json merge_limits(const LimitPlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  Json sequences = Json::array();
  auto result = results.begin();
  for (const LimitPlan::Controller& controller : plan.controllers) {
    for (const BlindQuantity& quantity : plan.quantities) {
      RowSummary summary;
      for (int i = 0; i < phases_of(plan, quantity) * plan.seeds; ++i) summary.add(*result++);
      rows.push_back(summary.row(plan, controller, quantity, phases_of(plan, quantity)));
    }
    if (plan.sequences == 0) continue;
    int survived = 0;
    Json runs = Json::array();
    for (int i = 0; i < plan.sequences; ++i) {
      survived += result->at("survived").get<bool>() ? 1 : 0;
      runs.push_back(*result++);
    }
    sequences.push_back({{"controller", controller.name},
                         {"horizon_s", controller.horizon_s},
                         {"survived", survived},
                         {"of", plan.sequences},
                         {"duration_s", plan.sequence_s},
                         {"runs", std::move(runs)}});
  }
  return {{"rows", std::move(rows)}, {"sequences", std::move(sequences)}};
}

std::string limit_table(const Json& merged) {
  std::string table =
      "| controller | horizon s | what | direction | all | half | cases | last tried | mean speed at the "
      "limit m/s "
      "|\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    table += "| " + row.at("controller").get<std::string>() + " | " +
             simulation::decimals_text(row.at("horizon_s"), 1) + " | " +
             row.at("quantity").get<std::string>() + ", " + row.at("unit").get<std::string>() + " | " +
             row.at("direction").get<std::string>() + " | " + cell(row.at("limit_all"), "%g", "none") +
             " | " + cell(row.at("limit_half"), "%g", "none") + " | " +
             std::to_string(row.at("cases").get<int>()) + " | " + cell(row.at("last_tried"), "%g", "-") +
             " | " + cell(row.at("speed_min_m_s"), "%.2f", "-") + " to " +
             cell(row.at("speed_max_m_s"), "%.2f", "-") + " |\n";
  }
  for (const Json& sequence : merged.at("sequences")) {
    table += '\n';
    table += sequence.at("controller").get<std::string>() + ", horizon " +
             simulation::decimals_text(sequence.at("horizon_s"), 1) +
             " s: " + cell(sequence.at("survived"), "%.0f") + " of " + cell(sequence.at("of"), "%.0f") +
             " random sequences of commands, " + cell(sequence.at("duration_s"), "%.0f") +
             " s each, survived\n";
  }
  return table;
}

}  // namespace stilt::experiments
