#pragma once

#include <expected>
#include <ostream>
#include <span>
#include <string>

#include "firmware/control_loop/tick_record.h"

/// Records of ticks as text, for ordinary threads.
///
/// The file: comma-separated values, one line of column names, then one line per tick, oldest first. Names
/// carry unit and joint: time_s, hip_L_position_rad, ..., estimated_z_b_m, sent_knee_R_torque_Nm, ... Numbers
/// are the shortest that read back the same, nan where a sensor gave nothing. state, fallback_level, reaction
/// and action are words; faults and latched_faults are names of faults joined by +, empty without any.
namespace stilt::diagnostics {

/// The line of column names.
void write_tick_header(std::ostream& out);

/// The line of one tick. time_s counts from `start_ns`.
void write_tick(std::ostream& out, const control_loop::TickRecord& record, std::int64_t start_ns);

/// Everything in a black box, which is frozen or not recorded into any more. The file is the old one or the
/// new one, whole. Does not wait for the disk: the robot may be on its feet, and its operator is the caller.
/// @param start_ns  time that shall be 0 in the file
/// @return what is wrong when the file cannot be written, in one sentence
[[nodiscard]] std::expected<void, std::string> write_csv(const std::string& path,
                                                         const control_loop::TickBlackBox& box,
                                                         std::int64_t start_ns);

}  // namespace stilt::diagnostics
