#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "firmware/configuration/gaits/gait_record.h"
#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {

/// No gait was found; one sentence, with what could be relaxed.
class NoGait : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Synthesis {
  gait::HzdGait gait;
  /// Integral of the cost over a step / step length; over the step alone at speed 0.
  double cost_per_m = 0.0;
  int iterations = 0;        ///< of Ipopt
  Eigen::VectorXd solution;  ///< variables of StepProgram
};

/// Slower than this the hip moves too little in a step to give the phase; the outputs follow the time since
/// touch-down instead, and foot placement makes up for the stability lost.
inline constexpr double kSlowestByHip_m_s = 0.15;
[[nodiscard]] gait::PhaseKind phase_for_speed(double speed_m_s);

/// The cost by its name in options and files: torque, power or acceleration. Nothing for another name.
[[nodiscard]] std::optional<CostKind> cost_of_name(std::string_view name);

/// Finds the gait of a task. Step time and step length of the gait are those of the hybrid model's periodic
/// motion, off the task's by the error of the collocation. Throws NoGait.
[[nodiscard]] Synthesis synthesize(const model::RobotModel& robot, const StepTask& task);

/// A gait file's content: the gait, its limits, the figures computed from it as claims, and how it was made.
[[nodiscard]] gait_files::GaitRecord make_record(const model::RobotModel& robot, const StepTask& task,
                                                 const Synthesis& synthesis);

}  // namespace stilt::gait_synthesis
