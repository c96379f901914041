#pragma once

#include <nlohmann/json.hpp>

#include "firmware/configuration/gaits/gait_record.h"
#include "host_tools/gait_synthesis/gait_check.h"

namespace stilt::cli {

/// The output of `stilt gait check --json`; non-finite numbers become null.
[[nodiscard]] nlohmann::ordered_json to_json(const gait_files::GaitRecord& record,
                                             const gait_synthesis::GaitCheck& check);

}  // namespace stilt::cli
