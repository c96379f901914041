#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "firmware/configuration/gaits/gait_record.h"
#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {

/// No gait was found. The message is one sentence with the limits that could be relaxed.
class NoGait : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Result of a synthesis.
struct Synthesis {
  gait::HzdGait gait;
  /// Integral of the cost over a step, divided by the step length; at speed 0 not divided.
  double cost_per_m = 0.0;
  int iterations = 0;        ///< of Ipopt
  int elements = 0;          ///< of the grid
  Eigen::VectorXd solution;  ///< variables of StepProgram on that grid
};

/// Below this speed the hip moves too little in a step to define the phase. The outputs then follow the time
/// since touch-down, and foot placement stabilises the gait.
inline constexpr double kSlowestByHip_m_s = 0.15;
[[nodiscard]] gait::PhaseKind phase_for_speed(double speed_m_s);

/// The cost with a name of options and files: torque, power or acceleration. Nothing for other names.
[[nodiscard]] std::optional<CostKind> cost_of_name(std::string_view name);

/// Finds the gait of a task. Step time and step length of the gait are those of the hybrid model's periodic
/// motion. They differ from the task's by the error of the collocation. While that error is beyond the
/// tolerances of the check, the elements are doubled, at most twice. Throws NoGait.
[[nodiscard]] Synthesis synthesize(const model::RobotModel& robot, const StepTask& task);

/// The content of a gait file: the gait, its limits, its metrics as claims, and how it was made.
[[nodiscard]] gait_files::GaitRecord make_record(const model::RobotModel& robot, const StepTask& task,
                                                 const Synthesis& synthesis);

}  // namespace stilt::gait_synthesis
