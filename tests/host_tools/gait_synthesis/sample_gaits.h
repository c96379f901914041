#pragma once

#include <string>
#include <vector>

#include "host_tools/gait_synthesis/gait_check.h"
#include "host_tools/gait_synthesis/motion_fit.h"
#include "host_tools/gait_synthesis/synthesize.h"
#include "tests/robots.h"

/// Gaits that several tests look at; each is found once.
namespace stilt::gait_synthesis {

inline StepTask task_at(double speed_m_s) {
  StepTask task;
  task.speed_m_s = speed_m_s;
  task.phase = phase_for_speed(speed_m_s);
  return task;
}

/// AMBER-3M at 0.5 m/s, outputs along the hip's position.
inline const gait_files::GaitRecord& walking_record() {
  static const gait_files::GaitRecord record = make_record(
      testing_support::amber3m(), task_at(0.5), synthesize(testing_support::amber3m(), task_at(0.5)));
  return record;
}
inline const gait::HzdGait& walking_gait() { return walking_record().gait; }

/// AMBER-3M in place, outputs along the time.
inline const gait_files::GaitRecord& stepping_record() {
  static const gait_files::GaitRecord record = make_record(
      testing_support::amber3m(), task_at(0.0), synthesize(testing_support::amber3m(), task_at(0.0)));
  return record;
}
inline const gait::HzdGait& stepping_gait() { return stepping_record().gait; }

/// AMBER-3M with other drives of one knee; both knees stand and swing in turn.
inline model::RobotModel with_knee_L(double torque_Nm, double speed_rad_s) {
  model::RobotModel robot = testing_support::amber3m();
  robot.constants.torque_limit_Nm[1] = torque_Nm;
  robot.constants.velocity_limit_rad_s[1] = speed_rad_s;
  return robot;
}

/// AMBER-3M with a stop of one knee; its range begins at 0 otherwise.
inline model::RobotModel with_stop(int knee, double least_rad) {
  model::RobotModel robot = testing_support::amber3m();
  robot.constants.position_min_rad[knee] = least_rad;
  return robot;
}

inline std::string joined(const std::vector<Violation>& violations) {
  std::string text;
  for (const Violation& violation : violations) text += violation.text() + "; ";
  return text;
}

}  // namespace stilt::gait_synthesis
