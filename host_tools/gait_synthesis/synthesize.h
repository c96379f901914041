#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "host_tools/gait_synthesis/step_program.h"

namespace stilt::gait_synthesis {

/// No gait was found; one sentence, with what could be relaxed.
class NoGait : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Synthesis {
  gait::HzdGait gait;
  CostKind cost_kind = CostKind::torque_squared;
  double cost_per_m =
      0.0;             ///< integral of the cost over a step / step length (over the step alone at speed 0)
  int iterations = 0;  ///< of Ipopt
  Eigen::VectorXd solution;
};

/// Slower than this the hip moves too little in a step to tell the phase; the outputs follow the time since
/// touch-down instead, and a foot placement gain makes up for the stability lost.
inline constexpr double kSlowestByHip_m_s = 0.15;
[[nodiscard]] gait::PhaseKind phase_for_speed(double speed_m_s);

/// Finds the gait of a task. `warm`: solution of a similar task of the same phase and degrees.
/// The placement gain is 0 for a phase by hip position; for a phase by time it is the one of a grid of gains
/// that gives the least spectral radius of the return map. \throws NoGait
[[nodiscard]] Synthesis synthesize(const model::RobotModel& robot, const StepTask& task,
                                   const Eigen::VectorXd* warm = nullptr);

}  // namespace stilt::gait_synthesis
