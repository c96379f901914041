#pragma once

#include <nlohmann/json.hpp>

#include "firmware/configuration/gaits/gait_record.h"
#include "host_tools/gait_synthesis/gait_check.h"

namespace stilt::cli {

/// What `stilt gait check --json` writes; numbers that are not finite become null.
[[nodiscard]] nlohmann::ordered_json to_json(const gait_files::GaitRecord& record,
                                             const gait_synthesis::GaitCheck& check);

}  // namespace stilt::cli
