#pragma once

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

}  // namespace stilt::gait_synthesis
