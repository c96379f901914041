#include "firmware/configuration/gaits/gait_record.h"

namespace stilt::gait_files {
namespace {

template <auto Member, class T>
std::span<double> member(T& object) {
  auto& value = object.*Member;
  if constexpr (std::is_array_v<std::remove_reference_t<decltype(value)>>) {
    return value;
  } else {
    return {&value, 1};
  }
}

using Limits = GaitLimits;
using Metrics = GaitMetrics;

template <auto Member>
constexpr Field<Limits> limit(const char* key, const char* meaning) {
  return {key, meaning, &member<Member, Limits>};
}

template <auto Member>
constexpr Field<Metrics> metric(const char* key, const char* meaning) {
  return {key, meaning, &member<Member, Metrics>};
}

constexpr Field<Limits> kLimits[] = {
    limit<&Limits::torque_Nm>("torque_Nm", "of each joint, either way"),
    limit<&Limits::joint_position_margin_rad>("joint_position_margin_rad",
                                              "to the ends of each joint's range"),
    limit<&Limits::knee_min_rad>("knee_min_rad", "least bend of the knees"),
    limit<&Limits::joint_speed_rad_s>("joint_speed_rad_s", "of each joint, either way"),
    limit<&Limits::pitch_rad>("pitch_rad", "of the torso, either way"),
    limit<&Limits::friction_ratio>("friction_ratio", "|fx| / fz of the stance foot"),
    limit<&Limits::normal_force_min_N>("normal_force_min_N", "least fz of the stance foot"),
    limit<&Limits::impulse_ratio>("impulse_ratio", "|x| / z of the impulse at touch-down"),
    limit<&Limits::clearance_m>("clearance_m",
                                "least height of the swing foot in the middle half of the step"),
    limit<&Limits::touchdown_speed_min_m_s>("touchdown_speed_min_m_s", "downward speed at touch-down, least"),
    limit<&Limits::touchdown_speed_max_m_s>("touchdown_speed_max_m_s", "and most"),
    limit<&Limits::touchdown_slip_m_s>("touchdown_slip_m_s", "horizontal speed of the foot that lands"),
    limit<&Limits::return_map>("return_map", "largest eigenvalue magnitude of the return map"),
};

constexpr Field<Metrics> kMetrics[] = {
    metric<&Metrics::defect_max>("defect_max",
                                 "of one interval of a grid four times finer than the optimisation's"),
    metric<&Metrics::periodicity_error>("periodicity_error", "after impact and leg swap, rad and rad/s"),
    metric<&Metrics::output_error_max_rad>("output_error_max_rad", "motion against outputs"),
    metric<&Metrics::torque_error_max_Nm>("torque_error_max_Nm", "torque curves against inverse dynamics"),
    metric<&Metrics::replay_error_max>("replay_error_max", "over five steps under the feedback, m and rad"),
    metric<&Metrics::return_map_eigenvalues>("return_map_eigenvalues", "magnitudes, largest first"),
    metric<&Metrics::peak_torque_Nm>("peak_torque_Nm", "stance hip, stance knee, swing hip, swing knee"),
    metric<&Metrics::peak_joint_speed_rad_s>("peak_joint_speed_rad_s", "same order"),
    metric<&Metrics::joint_position_margin_rad>("joint_position_margin_rad", "to the ends of the ranges"),
    metric<&Metrics::knee_min_rad>("knee_min_rad", "least bend"),
    metric<&Metrics::pitch_max_rad>("pitch_max_rad", "largest magnitude"),
    metric<&Metrics::friction_ratio_max>("friction_ratio_max", "|fx| / fz"),
    metric<&Metrics::normal_force_min_N>("normal_force_min_N", "of the stance foot"),
    metric<&Metrics::impulse_ratio>("impulse_ratio", "|x| / z"),
    metric<&Metrics::clearance_m>("clearance_m", "middle half of the step"),
    metric<&Metrics::swing_height_min_m>("swing_height_min_m", "from 5 % to 95 % of the step"),
    metric<&Metrics::touchdown_speed_m_s>("touchdown_speed_m_s", "downward"),
    metric<&Metrics::touchdown_slip_m_s>("touchdown_slip_m_s", "forward"),
    metric<&Metrics::torque_squared_per_m>("torque_squared_per_m", "N^2 m s, 0 in place"),
};

}  // namespace

std::span<const Field<GaitLimits>> limit_fields() { return kLimits; }
std::span<const Field<GaitMetrics>> metric_fields() { return kMetrics; }

}  // namespace stilt::gait_files
