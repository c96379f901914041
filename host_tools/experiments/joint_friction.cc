#include "host_tools/experiments/joint_friction.h"

#include <cmath>

#include "host_tools/experiments/table_text.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::experiments {
namespace {

using model::kFirstJoint;
using model::kJoints;

struct Variant {
  const char* name;
  bool in_plant;
  bool in_configuration;
};
constexpr Variant kVariants[] = {
    {"no_friction", false, false}, {"unknown", true, false}, {"configured", true, true}};

double joint_error_rms_rad(const std::vector<log::RunSample>& samples) {
  double sum = 0.0;
  for (const log::RunSample& sample : samples) {
    const model::StateVector error = sample.planned_state - sample.true_state;
    sum += error.segment<kJoints>(kFirstJoint).squaredNorm();
  }
  return std::sqrt(sum / (kJoints * static_cast<double>(samples.size())));
}

Json run_job(const FrictionPlan& plan, const FrictionPlan::Rate& rate, const Variant& variant,
             const WalkRunner& run) {
  const std::string friction_Nm = simulation::number_text(plan.friction_Nm);
  WalkCase walk;
  walk.controller = plan.controller;
  walk.horizon_s = plan.horizon_s;
  walk.command = plan.command;
  walk.duration_s = plan.duration_s;
  walk.sensor_noise_scale = 0.0;
  walk.settings = {"timing.plan_rate_hz=" + simulation::number_text(rate.plan_rate_hz),
                   "timing.plan_delay_s=" + simulation::number_text(rate.plan_delay_s)};
  if (variant.in_configuration) {
    walk.settings.push_back("robot.hip_coulomb_friction_Nm=" + friction_Nm);
    walk.settings.push_back("robot.knee_coulomb_friction_Nm=" + friction_Nm);
  }
  if (variant.in_plant) walk.plant = {"joint_friction_Nm=" + friction_Nm};
  walk.keep_samples = true;
  walk.sample_every_tick = true;
  const log::RunRecord record = run(walk);
  return {{"survived", record.summary.survived}, {"joint_error_rad", joint_error_rms_rad(record.samples)}};
}

}  // namespace

std::vector<Job> friction_jobs(const FrictionPlan& plan, const WalkRunner& run) {
  std::vector<Job> jobs;
  for (const FrictionPlan::Rate& rate : plan.rates) {
    for (const Variant& variant : kVariants) {
      jobs.push_back({"rate_" + simulation::number_text(rate.plan_rate_hz) + "_" + variant.name,
                      [=] { return run_job(plan, rate, variant, run); }});
    }
  }
  return jobs;
}

Json merge_friction(const FrictionPlan& plan, const std::vector<Json>& results) {
  Json rows = Json::array();
  auto result = results.begin();
  for (const FrictionPlan::Rate& rate : plan.rates) {
    Json row = {{"controller", plan.controller},
                {"horizon_s", plan.horizon_s},
                {"friction_Nm", plan.friction_Nm},
                {"duration_s", plan.duration_s},
                {"plan_rate_hz", rate.plan_rate_hz},
                {"plan_delay_s", rate.plan_delay_s},
                {"survived", true}};
    for (const Variant& variant : kVariants) {
      if (!result->at("survived").get<bool>()) row["survived"] = false;
      row[std::string(variant.name) + "_rad"] = result->at("joint_error_rad");
      ++result;
    }
    row["configured_over_unknown"] =
        row.at("configured_rad").get<double>() / row.at("unknown_rad").get<double>();
    rows.push_back(std::move(row));
  }
  return {{"rows", std::move(rows)}};
}

std::string friction_table(const Json& merged) {
  std::string table =
      "| plans per second | delay of a plan s | no friction rad | friction, unknown rad | friction, "
      "configured "
      "rad | configured over unknown |\n"
      "|---|---|---|---|---|---|\n";
  for (const Json& row : merged.at("rows")) {
    table += "| " + simulation::number_text(row.at("plan_rate_hz")) + " | " +
             simulation::decimals_text(row.at("plan_delay_s"));
    for (const char* key : {"no_friction_rad", "unknown_rad", "configured_rad"}) {
      table += " | " + cell(row.at(key), "%.5f");
    }
    table += " | " + cell(row.at("configured_over_unknown"), "%.2f") +
             (row.at("survived").get<bool>() ? "" : ", falls") + " |\n";
  }
  return table;
}

}  // namespace stilt::experiments
