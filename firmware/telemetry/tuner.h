#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/configuration/live.h"
#include "firmware/control_loop/mailboxes.h"
#include "mpc_core/model/robot.h"

namespace stilt::telemetry {

/// Live tunables: checks a new value and works out what the planner needs of it (milliseconds). Torque loop
/// and planner take it before their next tick and solve. Ordinary threads.
class Tuner {
 public:
  /// Everything outlives this object.
  Tuner(const configuration::Configuration& configuration, const model::RobotModel& robot,
        control_loop::Mailboxes& mail);

  /// Sets one. Empty, or what is wrong in one sentence; then nothing changed.
  [[nodiscard]] std::string set(const std::string& key, double value);

  [[nodiscard]] const std::vector<configuration::LiveTunable>& tunables() const noexcept { return tunables_; }

  /// Counts changes; 0: as configured.
  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  /// Active from this number on, in the order of tunables().
  [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }
  /// Active height of the hip.
  [[nodiscard]] double base_height_m() const noexcept { return settings_.parameters.reference.base_height_m; }
  /// What the planner has.
  [[nodiscard]] const control::PlannerSettings& settings() const noexcept { return settings_; }

 private:
  [[nodiscard]] bool prepare(const configuration::Configuration& changed);
  /// What a configuration file with these values would be refused for; empty: nothing.
  [[nodiscard]] std::string mistake_of(const configuration::Configuration& changed) const;

  const configuration::Configuration& configuration_;
  const model::RobotModel& robot_;
  control_loop::Mailboxes& mail_;
  std::vector<configuration::LiveTunable> tunables_;
  std::vector<double> values_;
  std::uint32_t number_ = 0;
  control::PlannerSettings settings_;
  std::unique_ptr<sqp::TerminalCostWorkspace> work_;
};

}  // namespace stilt::telemetry
