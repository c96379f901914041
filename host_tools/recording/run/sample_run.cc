#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "host_tools/recording/mean_speed.h"
#include "host_tools/recording/run/text_run.h"
#include "host_tools/recording/run/tick_run.h"
#include "host_tools/simulation/closed_loop/step_detector.h"

namespace stilt::record {
namespace {

using Json = nlohmann::json;

/// Numbers that are not finite are null in JSON.
double number(const Json& json) { return json.is_null() ? kUnknown : json.get<double>(); }

template <class Vector>
void read(const Json& json, Vector& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = number(json.at(static_cast<std::size_t>(i)));
}

/// The sample of a line, nothing when it is none.
std::optional<log::RunSample> sample_of(const std::string& line) try {
  const Json json = Json::parse(line);
  log::RunSample sample;
  sample.time_s = json.at("time_s").get<double>();
  read(json.at("true_state"), sample.true_state);
  read(json.at("estimated_state"), sample.estimated_state);
  read(json.at("planned_state"), sample.planned_state);
  read(json.at("torque_Nm"), sample.torque_Nm);
  read(json.at("contact_force_N"), sample.contact_force_N);
  read(json.at("planned_contact_force_N"), sample.planned_contact_force_N);
  read(json.at("foot_position_m"), sample.foot_position_m);
  sample.scheduled_mode = {json.at("scheduled_contact").at(0).get<bool>(),
                           json.at("scheduled_contact").at(1).get<bool>()};
  sample.push_N = number(json.at("push_N"));
  sample.push_above_hip_m = json.value("push_above_hip_m", 0.0);  // logs of release 0.1 lack it
  sample.commanded_speed_m_s = number(json.at("commanded_speed_m_s"));
  return sample;
} catch (const Json::exception&) {
  return std::nullopt;
}

void summarise(log::RunRecord& run) {
  simulation::StepDetector steps;
  log::MeanSpeed speed;
  log::RunSummary& summary = run.summary;
  summary.peak_torque_Nm.setConstant(kUnknown);
  summary.peak_joint_speed_rad_s.setConstant(kUnknown);
  for (const log::RunSample& sample : run.samples) {
    steps.update(sample.time_s, sample.contact_force_N, sample.foot_position_m, sample.true_state[0]);
    speed.add(sample.time_s, sample.true_state[0]);
    for (Eigen::Index i = 0; i < model::kJoints; ++i) {
      const double speed_rad_s = sample.true_state[model::kPositions + model::kFirstJoint + i];
      summary.peak_torque_Nm[i] = std::fmax(summary.peak_torque_Nm[i], std::abs(sample.torque_Nm[i]));
      summary.peak_joint_speed_rad_s[i] = std::fmax(summary.peak_joint_speed_rad_s[i], std::abs(speed_rad_s));
    }
  }
  const log::RunSample &first = run.samples.front(), &last = run.samples.back();
  summary.duration_s = last.time_s - first.time_s;
  summary.distance_m = last.true_state[0] - first.true_state[0];
  summary.mean_speed_m_s = speed.value_m_s();
  summary.slip_distance_m = kUnknown;
  summarise_steps(steps.steps(), summary);
}

}  // namespace

RecordRun run_of_samples(const std::string& path, const model::RobotConstants& robot) {
  RecordRun result;
  result.robot = robot;
  log::RunRecord& run = result.run;
  run.robot.name = robot.name;
  run.command_line = path + ", samples of --log, drawn as " + robot.name;
  run.outcome_known = false;
  std::ifstream file(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::optional<log::RunSample> sample = sample_of(line);
    if (!sample) {
      result.problems.push_back(path + ": line " + std::to_string(number) +
                                " is no sample of --log; the report ends before it");
      break;
    }
    run.samples.push_back(std::move(*sample));
  }
  if (run.samples.empty()) {
    throw std::runtime_error(path + ": holds no sample; name a file of stilt sim --log or stilt robot --log");
  }
  summarise(run);
  return result;
}

}  // namespace stilt::record
