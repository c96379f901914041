#pragma once

#include <cstdint>

#include "hal/robot/robot.h"
#include "mpc_core/control/estimator.h"

/// What estimator and detectors take from the readings of a tick. All functions may run in real time.
namespace stilt::control_loop {

/// A pitch is extrapolated for so long at most.
inline constexpr std::int64_t kLongestExtrapolation_ns = 10'000'000;

/// Joints and torso. The pitch is extrapolated with its rate to now_ns, by at most kLongestExtrapolation_ns,
/// because the torso sensor may be slower than the torque loop.
/// @param time_s  of the control loop
[[nodiscard]] control::SensorReading sensor_reading(double time_s, const hal::RobotReadings& readings,
                                                    std::int64_t now_ns) noexcept;

/// The sensors as a state; the hip stands still at the origin.
[[nodiscard]] model::StateVector measured_state(const control::SensorReading& reading) noexcept;

/// The reading of exact sensors.
[[nodiscard]] control::SensorReading exact_reading(double time_s, const model::StateVector& state) noexcept;

/// Height of the hip above the lower foot, as a share of the straight leg.
[[nodiscard]] double hip_height_share(const model::RobotModel& robot,
                                      const control::SensorReading& reading) noexcept;

}  // namespace stilt::control_loop
