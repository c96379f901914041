#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// The output of `stilt model eval` for one state x[14] and input u[8]; a matrix is a list of rows.
[[nodiscard]] nlohmann::ordered_json evaluate_model(const model::RobotModel& robot,
                                                    const model::StateVector& x, const model::InputVector& u);

/// Reads one {"x": [14], "u": [8]} per line and writes one result per line; skips empty lines. Throws
/// UsageError with the line's number when a line is not such an object.
void evaluate_lines(const model::RobotModel& robot, std::istream& input, std::ostream& output);

}  // namespace stilt::cli
