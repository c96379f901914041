#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

#include "mpc_core/model/robot.h"

namespace stilt::cli {

/// All that `stilt model eval` prints for one state x[14] and input u[8]; matrices are rows of rows.
[[nodiscard]] nlohmann::ordered_json evaluate_model(const model::RobotModel& robot,
                                                    const model::StateVector& x, const model::InputVector& u);

/// Reads one {"x": [14], "u": [8]} a line, writes one result a line; empty lines are skipped. Throws
/// UsageError with the line's number when a line is not such an object.
void evaluate_lines(const model::RobotModel& robot, std::istream& input, std::ostream& output);

}  // namespace stilt::cli
