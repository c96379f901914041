#pragma once

#include <string>

#include "host_tools/gait_synthesis/gait_check.h"

namespace stilt::gait_synthesis {

/// One gait as a self-contained HTML page. It shows a table of figures and limits, tiles of the posture over
/// a step, and phase portraits of the joints over two steps. It plots joints, torques, contact force and
/// swing foot over a step. Needs a known motion.
[[nodiscard]] std::string render_gait_page(const model::RobotModel& robot,
                                           const gait_files::GaitRecord& record, const GaitCheck& check);

}  // namespace stilt::gait_synthesis
