#include "host_tools/experiments/push_row.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace stilt::experiments {
namespace {

constexpr double kSlip_m = 0.01;
constexpr double kPapersPush_N = 20.0;
constexpr double kShareOfLimit = 0.8;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class T>
std::optional<T> optional(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<T>());
}

/// Largest push in the paper, at the hip; nothing where the paper shows none.
std::optional<double> paper_N(const PushRow& row) {
  static const std::map<std::pair<std::string, int>, double> kPaper = {
      {{"mpc-lumped", 20}, 2.0},    {{"mpc-none", 20}, 22.0}, {{"mpc-heuristic", 20}, 22.0},
      {{"mpc-heuristic", 5}, 22.0}, {{"mpc-hzd", 20}, 22.0},  {{"mpc-hzd", 5}, 22.0},
      {{"mpc-hzd", 2}, 20.0}};
  const bool published = row.robot == "amber3m" && row.command.kind == gait::GaitKind::walk &&
                         row.command.speed_m_s == 0.5 && !row.backward &&
                         (row.setting.is_null() || row.setting.value("push_at", "hip") == "hip");
  if (!published) return std::nullopt;
  if (row.controller == "hzd-pd") return 30.0;
  const auto found = kPaper.find({row.controller, static_cast<int>(std::lround(10.0 * row.horizon_s))});
  return found == kPaper.end() ? std::nullopt : std::optional(found->second);
}

const Json& unpushed(const Json& one) { return one.at("trials").at(0); }

/// The survived trials of a case; with force_N only those with that force.
std::vector<Json> survived(const Json& one, std::optional<double> force_N = std::nullopt) {
  std::vector<Json> trials;
  for (const Json& trial : one.at("trials")) {
    const bool asked = !force_N || trial.at("force_N").get<double>() == *force_N;
    if (asked && trial.at("survived").get<bool>()) trials.push_back(trial);
  }
  return trials;
}

/// Phase and seed of the two cases with the smallest limits.
Json worst_cases(std::span<const Json> cases) {
  std::vector<const Json*> ascending;
  for (const Json& one : cases) ascending.push_back(&one);
  const auto limit_N = [](const Json* one) {
    return one->at("limit_N").is_null() ? -1.0 : one->at("limit_N").get<double>();
  };
  std::ranges::stable_sort(ascending, {}, limit_N);
  ascending.resize(std::min<std::size_t>(2, ascending.size()));
  Json worst = Json::array();
  for (const Json* one : ascending) {
    worst.push_back(
        {{"phase", one->at("phase")}, {"seed", one->at("seed")}, {"limit_N", one->at("limit_N")}});
  }
  return worst;
}

/// The limits of all cases, ascending. Cases that fall without a push have no limit and come first.
std::vector<std::optional<double>> limits_of(std::span<const Json> cases) {
  std::vector<std::optional<double>> limits;
  for (const Json& one : cases) limits.push_back(optional<double>(one.at("limit_N")));
  std::ranges::sort(limits);
  return limits;
}

std::optional<double> mean_unpushed_speed_m_s(std::span<const Json> cases) {
  double sum_m_s = 0.0;
  int count = 0;
  for (const Json& one : cases) {
    if (!unpushed(one).at("survived").get<bool>()) continue;
    sum_m_s += unpushed(one).at("mean_speed_m_s").get<double>();
    ++count;
  }
  return count > 0 ? std::optional(sum_m_s / count) : std::nullopt;
}

/// Range of step lengths over the survived trials; with force_N only over those with that force.
std::optional<StepRange> steps_of(std::span<const Json> cases, std::optional<double> force_N = std::nullopt) {
  std::optional<StepRange> range;
  for (const Json& one : cases) {
    for (const Json& trial : survived(one, force_N)) {
      if (trial.at("step_length_min_m").is_null()) continue;
      const StepRange own{trial.at("step_length_min_m"), trial.at("step_length_max_m")};
      if (!range) range = own;
      *range = {std::min(range->min_m, own.min_m), std::max(range->max_m, own.max_m)};
    }
  }
  return range;
}

std::optional<double> first_slip_N(std::span<const Json> cases) {
  std::optional<double> first_N;
  for (const Json& one : cases) {
    const double unpushed_m = unpushed(one).at("slip_m").get<double>();
    for (const Json& trial : survived(one)) {
      if (trial.at("slip_m").get<double>() - unpushed_m < kSlip_m) continue;
      const double force_N = trial.at("force_N").get<double>();
      first_N = std::min(first_N.value_or(force_N), force_N);
    }
  }
  return first_N;
}

double saturated_s(std::span<const Json> cases) {
  double longest_s = 0.0;
  for (const Json& one : cases) {
    for (const Json& trial : survived(one)) {
      longest_s = std::max(longest_s, trial.at("saturated_s").get<double>());
    }
  }
  return longest_s;
}

/// Steps to recover after pushes of one force; null when no case survived it.
Json recovery(std::span<const Json> cases, double force_N) {
  std::vector<int> steps;
  std::size_t survivors = 0;
  for (const Json& one : cases) {
    for (const Json& trial : survived(one, force_N)) {
      ++survivors;
      if (const auto count = optional<int>(trial.at("recovery_steps"))) steps.push_back(*count);
    }
  }
  if (survivors == 0) return nullptr;
  std::ranges::sort(steps);
  const std::size_t middle = (survivors - 1) / 2;
  return {{"force_N", force_N},
          {"cases", survivors},
          {"recovered", steps.size()},
          {"median", middle < steps.size() ? Json(steps[middle]) : Json(nullptr)},
          {"max", steps.size() == survivors ? Json(steps.back()) : Json(nullptr)}};
}

/// Largest multiple of the coarse step below a force; every case that survives the smaller ones tries it.
double coarse_below_N(const PushRow& row, double force_N) {
  return std::floor(force_N / row.search.coarse_N + 1e-9) * row.search.coarse_N;
}

bool tries_papers_push(const PushRow& row) { return coarse_below_N(row, kPapersPush_N) == kPapersPush_N; }

Json recoveries(const PushRow& row, std::span<const Json> cases, std::optional<double> limit_N) {
  Json json = {{"at_20N", nullptr}, {"at_80_percent", nullptr}};
  if (row.command.kind == gait::GaitKind::stand) return json;
  if (tries_papers_push(row)) json["at_20N"] = recovery(cases, kPapersPush_N);
  const double force_N = coarse_below_N(row, kShareOfLimit * limit_N.value_or(0.0));
  if (force_N > 0.0) json["at_80_percent"] = recovery(cases, force_N);
  return json;
}

Json steps_at_20N(const PushRow& row, std::span<const Json> cases) {
  const auto steps = tries_papers_push(row) ? steps_of(cases, kPapersPush_N) : std::nullopt;
  if (!steps) return nullptr;
  return {{"min", steps->min_m}, {"max", steps->max_m}, {"range", steps->max_m - steps->min_m}};
}

}  // namespace

Json described(const DisturbancePlan& plan, const PushRow& row) {
  Json json = {{"name", row.name},
               {"robot", row.robot},
               {"controller", row.controller},
               {"horizon_s", row.controller == "hzd-pd" ? Json(nullptr) : Json(row.horizon_s)},
               {"gait", simulation::gait_name(row.command.kind)},
               {"speed_m_s", row.command.kind == gait::GaitKind::walk ? row.command.speed_m_s : 0.0},
               {"direction", row.backward ? "backward" : "forward"},
               {"phases", row.phases},
               {"seeds", row.seeds},
               {"coarse_N", row.search.coarse_N},
               {"fine_N", row.search.fine_N},
               {"settled_s", plan.settled_s},
               {"push_duration_s", plan.push_duration_s},
               {"recovery_s", plan.recovery_s}};
  if (!row.setting.is_null()) json.update(row.setting);
  return json;
}

Json merged_row(const DisturbancePlan& plan, const PushRow& row, std::span<const Json> cases) {
  const auto limits_N = limits_of(cases);
  Json all_N = Json::array();
  for (const auto& limit_N : limits_N) all_N.push_back(or_null(limit_N));
  const auto steps = steps_of(cases);
  const auto cases_walk =
      std::ranges::count_if(cases, [](const Json& one) { return unpushed(one).at("walks").get<bool>(); });
  Json json = described(plan, row);
  json["push_all_phases_N"] = or_null(limits_N.front());
  json["push_half_phases_N"] = or_null(limits_N[limits_N.size() / 2]);
  json["limits_N"] = std::move(all_N);
  json["worst_cases"] = worst_cases(cases);
  json["paper_N"] = or_null(paper_N(row));
  json["unpushed_speed_m_s"] = or_null(mean_unpushed_speed_m_s(cases));
  json["walks"] = static_cast<std::size_t>(cases_walk) == cases.size();
  json["cases_walk"] = cases_walk;
  json["cases"] = cases.size();
  json["step_length_range_m"] = steps ? Json(steps->max_m - steps->min_m) : Json(nullptr);
  json["step_length_min_m"] = steps ? Json(steps->min_m) : Json(nullptr);
  json["step_length_max_m"] = steps ? Json(steps->max_m) : Json(nullptr);
  json["step_length_at_20N_m"] = steps_at_20N(row, cases);
  json["first_slip_N"] = or_null(first_slip_N(cases));
  json["saturated_s"] = saturated_s(cases);
  json["recovery_steps"] = recoveries(row, cases, limits_N.front());
  return json;
}

}  // namespace stilt::experiments
