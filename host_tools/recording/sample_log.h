#pragma once

#include <string>

#include "host_tools/recording/run_record.h"

namespace stilt::log {

/// Writes the samples of a run, one JSON object per line, with the field names and units of RunSample.
/// The fields are time_s, true_state [14], estimated_state [14], planned_state [14], torque_Nm [4],
/// contact_force_N [4], planned_contact_force_N [4], foot_position_m [4], scheduled_contact [left, right],
/// push_N, push_above_hip_m, commanded_speed_m_s. To standard output when the name is "-". Throws
/// std::runtime_error, one sentence, when the file cannot be written.
void write_sample_log(const RunRecord& record, const std::string& file);

}  // namespace stilt::log
