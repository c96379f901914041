#include "firmware/configuration/consistency.h"

#include <algorithm>
#include <cmath>

#include "firmware/configuration/hardware_consistency.h"
#include "firmware/configuration/schema.h"
#include "mpc_core/ocp/horizon.h"

namespace stilt::configuration {
namespace {

/// Times that are equal but for rounding count as equal.
constexpr double kRounding = 1e-9;

void check_capacity(const Parameters& p, std::vector<Contradiction>& found) {
  const auto& grid = p.discretisation;
  const double intervals = ocp::most_intervals(grid);
  if (intervals > ocp::kMaxHorizonIntervals) {
    found.push_back({{"discretisation.horizon_s", "discretisation.time_step_s"},
                     "a horizon of " + number_text(grid.horizon_s) + " s in time steps of " +
                         number_text(grid.time_step_s) + " s takes " + number_text(intervals) +
                         " intervals, the capacity is " + std::to_string(ocp::kMaxHorizonIntervals) +
                         "; the horizon may be at most " +
                         number_text(ocp::kMaxHorizonIntervals * grid.time_step_s) + " s"});
  }
  const double switches = ocp::most_switches(grid, p.gait);
  if (switches > ocp::kMaxSwitches) {
    found.push_back({{"gait.single_support_s", "gait.double_support_s", "discretisation.horizon_s"},
                     "steps of " + number_text(p.gait.single_support_s) + " s with " +
                         number_text(p.gait.double_support_s) + " s of double support put " +
                         number_text(switches) + " contact switches into the horizon of " +
                         number_text(grid.horizon_s) + " s, the capacity is " +
                         std::to_string(ocp::kMaxSwitches) + "; take longer steps or a shorter horizon"});
  }
  if (grid.merge_below_s > 0.5 * grid.time_step_s) {
    found.push_back(
        {{"discretisation.merge_below_s", "discretisation.time_step_s"},
         "discretisation.merge_below_s = " + number_text(grid.merge_below_s) +
             " must be at most half of discretisation.time_step_s = " + number_text(grid.time_step_s)});
  }
  if (grid.horizon_s < grid.time_step_s) {
    found.push_back(
        {{"discretisation.horizon_s", "discretisation.time_step_s"},
         "discretisation.horizon_s = " + number_text(grid.horizon_s) +
             " must be at least one discretisation.time_step_s = " + number_text(grid.time_step_s)});
  }
}

void check_gait(const Parameters& p, std::vector<Contradiction>& found) {
  const auto& gait = p.gait;
  const double merge_s = p.discretisation.merge_below_s;
  if (gait.double_support_s > 0.0 && gait.double_support_s <= merge_s) {
    found.push_back({{"gait.double_support_s", "discretisation.merge_below_s"},
                     "gait.double_support_s = " + number_text(gait.double_support_s) +
                         " must be 0 or longer than discretisation.merge_below_s = " + number_text(merge_s)});
  }
  // The swing profile (mpc_core/gait/swing.h) is s^2 (16 apex (1 - s) + v T (1 - 2 s)). The bracket is linear
  // in s and not negative at its end, so neither anywhere when it is not at its start.
  const double drop_m = -gait.touchdown_velocity_m_s * gait.single_support_s / 16.0;
  if (gait.swing_height_m < drop_m - kRounding) {
    found.push_back({{"gait.touchdown_velocity_m_s", "gait.swing_height_m", "gait.single_support_s"},
                     "gait.touchdown_velocity_m_s = " + number_text(gait.touchdown_velocity_m_s) +
                         " is too fast for the swing to stay above the ground: with gait.swing_height_m = " +
                         number_text(gait.swing_height_m) + " and gait.single_support_s = " +
                         number_text(gait.single_support_s) + " it must be at least " +
                         number_text(-16.0 * gait.swing_height_m / gait.single_support_s)});
  }
  if (gait.catch_falls && gait.catch_margin_m >= gait.stand_half_width_m) {
    found.push_back({{"gait.catch_margin_m", "gait.stand_half_width_m"},
                     "gait.catch_margin_m = " + number_text(gait.catch_margin_m) +
                         " must be below gait.stand_half_width_m = " + number_text(gait.stand_half_width_m) +
                         ": no place between the feet would be free of steps"});
  }
  // A foot that swings would count as standing.
  constexpr double kBlendShare = 0.4;
  if (p.estimator.blend_s > kBlendShare * gait.single_support_s + kRounding) {
    found.push_back({{"estimator.blend_s", "gait.single_support_s"},
                     "estimator.blend_s = " + number_text(p.estimator.blend_s) +
                         " must be at most 0.4 gait.single_support_s = " +
                         number_text(kBlendShare * gait.single_support_s)});
  }
}

/// Over a time step h with the acceleration held, a stance foot has v <- (1 - kd h) v. A swinging one has
/// p <- p + h v + h^2 a / 2, v <- v + h a with a = -kp p - kd v. Stable where kd h < 2, and kp h < 2 kd.
void check_foot_gains(const Parameters& p, std::vector<Contradiction>& found) {
  const auto& gains = p.equality;
  const double h_s = p.discretisation.time_step_s;
  for (const auto& [key, kd_1_s] : {std::pair{"equality.stance_kd_1_s", gains.stance_kd_1_s},
                                    std::pair{"equality.swing_kd_1_s", gains.swing_kd_1_s}}) {
    if (kd_1_s * h_s < 2.0) continue;
    found.push_back({{key, "discretisation.time_step_s"},
                     std::string(key) + " = " + number_text(kd_1_s) +
                         " must be below 2 / discretisation.time_step_s = " + number_text(2.0 / h_s) +
                         ": the velocity of the planned foot would grow from step to step"});
  }
  if (gains.swing_kp_1_s2 * h_s > 2.0 * gains.swing_kd_1_s) {
    found.push_back({{"equality.swing_kp_1_s2", "equality.swing_kd_1_s", "discretisation.time_step_s"},
                     "equality.swing_kp_1_s2 = " + number_text(gains.swing_kp_1_s2) +
                         " must be at most 2 equality.swing_kd_1_s / discretisation.time_step_s = " +
                         number_text(2.0 * gains.swing_kd_1_s / h_s) +
                         ": the planned foot would swing more and more"});
  }
}

void check_feedback(const Parameters& p, std::vector<Contradiction>& found) {
  const auto& law = p.torque_law;
  if (law.feedback_from_age_s >= law.feedback_full_age_s) {
    found.push_back(
        {{"torque_law.feedback_from_age_s", "torque_law.feedback_full_age_s"},
         "torque_law.feedback_from_age_s = " + number_text(law.feedback_from_age_s) +
             " must be below torque_law.feedback_full_age_s = " + number_text(law.feedback_full_age_s)});
  }
  if (law.feedback_full_age_s > p.supervisor.plan_feedback_after_s) {
    found.push_back({{"torque_law.feedback_full_age_s", "supervisor.plan_feedback_after_s"},
                     "torque_law.feedback_full_age_s = " + number_text(law.feedback_full_age_s) +
                         " must be at most supervisor.plan_feedback_after_s = " +
                         number_text(p.supervisor.plan_feedback_after_s)});
  }
}

void check_timing(const Parameters& p, std::vector<Contradiction>& found) {
  const auto& timing = p.timing;
  if (timing.plan_rate_hz > timing.torque_rate_hz) {
    found.push_back({{"timing.plan_rate_hz", "timing.torque_rate_hz"},
                     "timing.plan_rate_hz = " + number_text(timing.plan_rate_hz) +
                         " must be at most timing.torque_rate_hz = " + number_text(timing.torque_rate_hz)});
  }
  // The least age. On a virtual clock a delay longer than the period makes plans that much rarer, and they
  // get twice the delay old. Experiments do so on purpose, and a gait leads the robot meanwhile.
  const double age_s = timing.plan_delay_s + 1.0 / timing.plan_rate_hz;
  // Until then a plan is used: it ends, or the supervisor counts it as stale.
  for (const auto& [key, usable_s] : {std::pair{"discretisation.horizon_s", p.discretisation.horizon_s},
                                      std::pair{"supervisor.stale_plan_s", p.supervisor.stale_plan_s}}) {
    if (age_s <= usable_s) continue;
    found.push_back({{"timing.plan_delay_s", "timing.plan_rate_hz", key},
                     "a plan is at least timing.plan_delay_s + 1 / timing.plan_rate_hz = " +
                         number_text(age_s) + " s old when the next one comes, which must be at most " +
                         std::string(key) + " = " + number_text(usable_s)});
  }
}

/// A time that the rates leave no room for when it is shorter.
struct LeastTime {
  std::vector<std::string_view> keys;  ///< its own first
  double value_s = 0;
  std::string_view rule;  ///< "two ticks, 2 / timing.torque_rate_hz"
  double least_s = 0;
  std::string_view otherwise;
};

void require(const LeastTime& time, std::vector<Contradiction>& found) {
  if (time.value_s >= time.least_s - kRounding) return;
  found.push_back({time.keys, std::string(time.keys.front()) + " = " + number_text(time.value_s) +
                                  " must be at least " + std::string(time.rule) + " = " +
                                  number_text(time.least_s) + "; " + std::string(time.otherwise)});
}

void check_times(const Configuration& configuration, std::vector<Contradiction>& found) {
  const HardwareParameters& hardware = configuration.hardware;
  const TorsoSensorParameters& sensor = hardware.torso_sensor;
  const double tick_s = 1.0 / configuration.timing.torque_rate_hz;
  require({{"supervisor.torque_loop_stall_s", "timing.torque_rate_hz"},
           configuration.supervisor.torque_loop_stall_s,
           "two ticks, 2 / timing.torque_rate_hz",
           2.0 * tick_s,
           "every tick would count as a stall"},
          found);
  // A reply to what a tick sends is received by the next tick.
  require({{"hardware.longest_reply_lag_s", "timing.torque_rate_hz"},
           hardware.longest_reply_lag_s,
           "a tick, 1 / timing.torque_rate_hz",
           tick_s,
           "every driver would be refused for slow replies"},
          found);
  // One command may be lost.
  require({{"hardware.driver_watchdog_s", "timing.torque_rate_hz"},
           hardware.driver_watchdog_s,
           "three ticks, 3 / timing.torque_rate_hz",
           3.0 * tick_s,
           "drivers would disable themselves"},
          found);
  // One step may be half over, and the next one takes the speed away.
  const gait::GaitParameters& gait = configuration.gait;
  require({{"supervisor.slow_down_s", "gait.single_support_s", "gait.double_support_s"},
           configuration.supervisor.slow_down_s,
           "two steps, 2 (gait.single_support_s + gait.double_support_s)",
           2.0 * (gait.single_support_s + gait.double_support_s),
           "a walk would stand and sit before it has slowed down"},
          found);
  if (sensor.emergency_stop_released == "none") return;
  require({{"torso_sensor.emergency_stop_timeout_s", "torso_sensor.rate_hz", "timing.torque_rate_hz"},
           sensor.emergency_stop_timeout_s,
           "two frames and two ticks, 2 / torso_sensor.rate_hz + 2 / timing.torque_rate_hz",
           2.0 / sensor.rate_hz + 2.0 * tick_s,
           "a released stop would count as silent"},
          found);
}

/// A driver that reports by its own clock answers nothing, so that no lag of it is measured at bring-up. Its
/// readings get a period and a tick old.
void check_report_age(const Configuration& configuration, std::vector<Contradiction>& found) {
  const HardwareParameters& hardware = configuration.hardware;
  const double lag_s = hardware.longest_reply_lag_s;
  for (const auto& [key, driver] : {std::pair{"hip_driver.ak_v3_status_rate_hz", &hardware.hip},
                                    std::pair{"knee_driver.ak_v3_status_rate_hz", &hardware.knee}}) {
    const double age_s = 1.0 / driver->ak_v3_status_rate_hz + 1.0 / configuration.timing.torque_rate_hz;
    if (driver->protocol != DriverProtocol::ak_v3 || age_s <= lag_s + kRounding) continue;
    found.push_back({{key, "hardware.longest_reply_lag_s"},
                     std::string(key) + " = " + number_text(driver->ak_v3_status_rate_hz) +
                         ": readings get a period and a tick old, " + number_text(age_s) +
                         " s, and hardware.longest_reply_lag_s = " + number_text(lag_s) +
                         "; let the driver report more often, or allow for that"});
  }
}

void check_line_search(const Parameters& p, std::vector<Contradiction>& found) {
  if (p.sqp.filter_violation_min > p.sqp.filter_violation_max) {
    found.push_back(
        {{"sqp.filter_violation_min", "sqp.filter_violation_max"},
         "sqp.filter_violation_min = " + number_text(p.sqp.filter_violation_min) +
             " must be at most sqp.filter_violation_max = " + number_text(p.sqp.filter_violation_max)});
  }
}

}  // namespace

std::vector<Contradiction> contradictions(const Configuration& parameters) {
  std::vector<Contradiction> found;
  check_capacity(parameters, found);
  check_gait(parameters, found);
  check_feedback(parameters, found);
  check_timing(parameters, found);
  check_times(parameters, found);
  check_report_age(parameters, found);
  check_line_search(parameters, found);
  check_foot_gains(parameters, found);
  check_hardware(parameters.hardware, found);
  check_torso_range(parameters.hardware, parameters.supervisor, found);
  check_gains(parameters.hardware, parameters.supervisor, found);
  check_supply(parameters.hardware, parameters.supervisor, found);
  check_supervisor(parameters.supervisor, found);
  check_runtime(parameters.runtime, found);
  return found;
}

}  // namespace stilt::configuration
