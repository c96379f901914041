#pragma once

#include "firmware/configuration/gaits/gait_record.h"
#include "mpc_core/model/robot.h"

namespace stilt::gait_synthesis {

/// Metrics of a gait with a known motion, computed from outputs, feedback, states and inputs. An eigenvalue
/// of the return map is infinite when a slightly disturbed step falls. The replay error is infinite when the
/// gait falls.
[[nodiscard]] gait_files::GaitMetrics gait_metrics(const model::RobotModel& robot, const gait::HzdGait& gait);

}  // namespace stilt::gait_synthesis
