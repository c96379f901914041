#include "firmware/telemetry/tuner.h"

#include <algorithm>
#include <cmath>

#include "firmware/configuration/consistency.h"
#include "firmware/configuration/reach.h"

namespace stilt::telemetry {

using configuration::LiveTunable;
using configuration::number_text;

Tuner::Tuner(const configuration::Configuration& configuration, const model::RobotModel& robot,
             control_loop::Mailboxes& mail)
    : configuration_(configuration),
      robot_(robot),
      mail_(mail),
      tunables_(configuration::live_tunables(configuration)),
      work_(std::make_unique<sqp::TerminalCostWorkspace>()) {
  for (const LiveTunable& tunable : tunables_) values_.push_back(tunable.start_value);
  static_cast<void>(prepare(configuration));  // the planner was configured with them already
}

bool Tuner::prepare(const configuration::Configuration& changed) {
  control::PlannerSettings settings;
  if (control::prepare_settings(robot_, changed, *work_, settings) != control::ConfigureStatus::ok)
    return false;
  settings_ = settings;
  return true;
}

std::string Tuner::mistake_of(const configuration::Configuration& changed) const {
  const auto contradictions = configuration::contradictions(changed);
  if (!contradictions.empty()) return contradictions.front().message;
  const auto poses = configuration::unreachable_poses(changed, robot_.constants);
  return poses.empty() ? "" : poses.front();
}

std::string Tuner::set(const std::string& key, double value) {
  const auto found =
      std::ranges::find_if(tunables_, [&](const LiveTunable& t) { return t.entry->name() == key; });
  if (found == tunables_.end()) {
    return "\"" + key +
           "\" is no key that may change while the robot runs; the configuration topic lists them";
  }
  if (!(value >= found->minimum && value <= found->maximum)) {
    return key + " = " + number_text(value) + " is outside its live range, " + number_text(found->minimum) +
           " to " + number_text(found->maximum) + " " + std::string(found->entry->unit);
  }
  std::vector<double> values = values_;
  values[static_cast<std::size_t>(found - tunables_.begin())] = value;
  const configuration::Configuration changed = configuration::with_live_values(configuration_, values);
  std::string mistake = mistake_of(changed);
  if (mistake.empty() && !prepare(changed)) mistake = "the weights admit no terminal cost";
  if (!mistake.empty()) return key + " = " + number_text(value) + ": " + mistake;
  values_ = values;
  ++number_;
  mail_.torque_tunings.writer() = {number_, settings_.parameters.torque_law};
  mail_.torque_tunings.publish();
  mail_.planner_tunings.writer() = {number_, settings_};
  mail_.planner_tunings.publish();
  return {};
}

}  // namespace stilt::telemetry
