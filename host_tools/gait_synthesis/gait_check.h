#pragma once

#include <string>
#include <vector>

#include "firmware/configuration/gaits/gait_record.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Tolerances for the values that a gait file states about its gait.
struct CheckTolerances {
  double defect = 1e-6;          ///< defect_max
  double periodicity = 1e-5;     ///< periodicity_error, rad and rad/s
  double output_rad = 1e-6;      ///< output_error_max_rad
  double torque_Nm = 1e-2;       ///< torque_error_max_Nm
  double replay = 1e-5;          ///< replay_error_max
  double speed_m_s = 1e-5;       ///< speed against step length / step time
  double claim_relative = 1e-3;  ///< claim against the computed value, plus claim_absolute
  double claim_absolute = 1e-4;
};

/// A limit, tolerance or claim that a gait violates.
struct Violation {
  enum class Bound { at_most, at_least, claimed };
  std::string name;
  double value = 0.0;  ///< computed; of several joints the worst one
  Bound kind = Bound::at_most;
  double bound = 0.0;
  bool accuracy = false;  ///< of the motion in the file; neither a limit nor a claim

  /// "clearance_m 0.008, at least 0.01"
  [[nodiscard]] std::string text() const;
};

/// Text of a bound: "at most", "at least", "claimed".
[[nodiscard]] const char* name(Violation::Bound kind);

/// Result of check_gait().
struct GaitCheck {
  gait_files::GaitMetrics metrics;
  std::vector<Violation> violations;  ///< of limits and claims; empty when valid
  [[nodiscard]] bool valid() const { return violations.empty(); }
};

/// Why a robot can have no gait, one sentence: a gait is one step, which both legs take in turn. Empty when
/// both have the same armature and damping. The URDF reader compares their masses and lengths.
[[nodiscard]] std::string unequal_legs(const model::RobotConstants& robot);

/// Computes the metrics of a gait from outputs, feedback, states and inputs, and compares them with limits,
/// tolerances and claims. Torques, joint speeds and positions also keep to the robot's own limits, those of
/// both legs. Names of violations: those of the limits; "defect", "periodicity", "outputs", "torque_curve",
/// "replay", "speed" (its difference from step length / step time). "swing_height" is for a swing foot below
/// the ground; "return_map", also when a disturbed step falls; "claim KEY".
[[nodiscard]] GaitCheck check_gait(const model::RobotModel& robot, const gait_files::GaitRecord& record,
                                   const CheckTolerances& tolerances = {});

/// Finds the periodic motion of a gait that has only outputs, and fills in states, inputs, step time, step
/// length and speed. Placement gains that are all 0 are found as place_feet() does, where it can; others
/// stay. Limits and claims stay as they are. Without a step time the search starts at `speed_m_s`, or at the
/// speed of one step per 0.4 s. Throws std::runtime_error, one sentence, when the outputs give no periodic
/// motion.
void complete_motion(const model::RobotModel& robot, gait::HzdGait& gait);

}  // namespace stilt::gait_synthesis
